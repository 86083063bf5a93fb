"""A verdict in sentences: the question, the answer, the doubts and the next step."""

from typing import NamedTuple

from diagnosis import Verdict
from diagnosis.verdict import Fit, Found
from experiments.diagnosis_report.findings import (
    MANY,
    at_number,
    findings,
    pulse_sentences,
    told_together,
)
from experiments.diagnosis_report.numbers import (
    error_unit,
    errors_text,
    percent,
    sure_text,
)
from experiments.diagnosis_report.place_words import (
    answer_words,
    at_words,
    channel_words,
    choice,
    listing,
    place_words,
    sentence,
)

BADGES = {
    "effects": "missing physics found",
    "none": "nothing missing",
    "unknown": "unknown physics",
    "not_identifiable": "these data cannot tell",
}
"""Words for each kind of verdict, if the question is what physics the sim lacks."""

CHANGE_BADGES = {
    "effects": "changed since the reference",
    "none": "nothing has changed since the reference",
    "unknown": "changed since the reference, by unknown physics",
    "not_identifiable": "these data cannot tell whether anything has changed",
}
"""Words for each kind of verdict, if reference recordings of the healthy robot were
given, so that the question is what has changed since then."""


def badge(verdict: Verdict, changed: bool = False) -> str:
    """The kind of a verdict in a few words.

    With `changed` they are about changes since reference recordings.
    """
    return (CHANGE_BADGES if changed else BADGES)[verdict.kind]


def question(robot: str, changed: bool) -> str:
    """The question that a diagnosis answers: what changed, or what the sim lacks."""
    if changed:
        return f"What has changed about {robot} since the reference recordings?"
    return f"What does the sim of {robot} lack that its recordings show?"


def answer(verdict: Verdict, changed: bool = False) -> list[str]:
    """The answer of a diagnosis in a few sentences, the most important first.

    With `changed` the question is what has changed since the reference recordings, not
    what physics the sim lacks.
    """
    pulses = [*map(sentence, pulse_sentences(verdict.pulses))]
    what = "has changed" if changed else "is missing"
    if verdict.kind == "none":
        return [*_nothing(verdict, what), *_small(verdict), *pulses]
    first, before = list[str](), ""
    if verdict.kind == "unknown":
        first, before = _unknown(verdict, what), "besides, "
    elif verdict.kind == "not_identifiable":
        first, before = _open(verdict, what), "this much is sure: "
    found = [before + each for each in findings(verdict.effects, changed)]
    said = [*first, *map(sentence, found), *pulses, *_gain(verdict)]
    return [*said, *_small(verdict)]


class Headline(NamedTuple):
    """Held-out errors, as texts, of the channel in which the nominal sim is worst.

    Attributes:
      channel: name of the channel in words.
      nominal: rms error of the nominal sim.
      corrected: rms error of the corrected sim.
      floor: noise floor of the channel.
      unit: unit of these three numbers.
    """

    channel: str
    nominal: str
    corrected: str
    floor: str
    unit: str


def headline(fit: Fit | None) -> Headline | None:
    """The errors of the worst channel in `fit`; None if no data were held out."""
    if fit is None or not fit.channels:
        return None
    name, worst = max(fit.channels.items(), key=lambda item: item[1].excess)
    errors = (worst.nominal, worst.corrected, worst.floor)
    factor, unit = error_unit(worst.unit, max(errors))
    nominal, corrected, floor = errors_text(factor * error for error in errors)
    return Headline(channel_words(name), nominal, corrected, floor, unit)


def _small(verdict: Verdict) -> list[str]:
    """A sentence on values that differ from the model by no more than is usual."""
    if not verdict.small:
        return []
    names = listing([at_words(one) for one in verdict.small], "and")
    return [
        f"These values differ from the model by no more than is usual: {names}; that "
        "is no evidence of missing physics."
    ]


def _gain(verdict: Verdict) -> list[str]:
    """A sentence on the errors without and with correction; none without effects."""
    errors, fit = headline(verdict.fit), verdict.fit
    if errors is None or fit is None or not verdict.effects:
        return []
    one = "it" if len(verdict.effects) == 1 else "these"
    gain = (
        f"With {one} the sim's error in {errors.channel}, on held-out recordings, "
        f"falls from {errors.nominal} to {errors.corrected} {errors.unit}; the noise "
        f"floor is {errors.floor}."
    )
    closed = fit.closed(fit.corrected)
    if closed is not None and closed >= 1:
        gain += " Over all channels, no error above the noise floor is left."
    elif closed is not None:
        part = f"{percent(max(closed, 0.0))} of the error above the noise floor"
        gain += f" Over all channels, {part} is gone."
    return [gain]


def _nothing(verdict: Verdict, what: str) -> list[str]:
    lines = [f"Nothing {what} that these recordings could show."]
    errors = headline(verdict.fit)
    if errors:
        lines.append(
            f"Even where it is largest, in {errors.channel}, the sim's error on "
            f"held-out recordings is {errors.nominal} {errors.unit}; the noise floor "
            f"is {errors.floor}."
        )
    if verdict.smallest_detectable:
        lines.append(
            "Smaller effects may be there; the sizes that these recordings could have "
            "shown are listed below."
        )
    return lines


def _unknown(verdict: Verdict, what: str) -> list[str]:
    lines = [f"Something {what} that no effect known here explains."]
    rest = verdict.unexplained
    if rest is not None:
        lines.append(
            f"{percent(rest.share)} of the squared error above the noise is left, most "
            f"of it in {channel_words(rest.channel)}; its shape is shown below."
        )
    return lines


def _open(verdict: Verdict, what: str) -> list[str]:
    if not verdict.alternatives:
        told = f"These recordings cannot tell whether anything {what}."
        return [told, verdict.limits[0]]
    if len(verdict.alternatives) == 1:
        hint = answer_words(verdict.alternatives[0])
        return [f"These recordings hint at {hint}, but do not confirm it."]
    return [
        "Something differs, but these recordings fit several explanations equally "
        f"well: {choice(verdict.alternatives)}."
    ]


def doubts(verdict: Verdict) -> list[str]:
    """Sentences on how sure each effect is, and on other answers that fit as well.

    What holds for an effect at many places is said once.
    """
    lines = []
    for group in told_together(verdict.effects):
        alike = dict[str, list[Found]]()
        for effect in group:
            alike.setdefault(_how_sure(effect), []).append(effect)
        for said, own in alike.items():
            about = [at_words(one) for one in own]
            if len(own) >= MANY:
                about = [at_number(own)]
            lines += [sentence(f"{one}: {said}") for one in about]
    answers = [answer_words(one) for one in verdict.alternatives]
    if answers and verdict.kind != "not_identifiable":
        lines.append(f"Other answers that fit about as well: {listing(answers, 'or')}.")
    return lines


def _how_sure(effect: Found) -> str:
    """How sure an effect is, and what else it may be."""
    rest = "no other effect known here explains the recordings as well"
    others = [at_words(other) for other in effect.confusable_with]
    if others:
        rest = f"the recordings do not rule out {listing(others, 'or')} instead"
    return f"{sure_text(effect.probability)}; {rest}"


def next_step(verdict: Verdict) -> str:
    """The experiment that would answer most open questions; "" if none is open."""
    step = verdict.next_experiment
    if step is None:
        return ""
    joint = f" of {place_words(step.joint)}" if step.joint else ""
    return f"Record {step.motion}{joint}: {step.why.rstrip('.')}."
