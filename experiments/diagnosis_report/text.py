"""What a verdict says, in sentences."""

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

from diagnosis.verdict.verdict import Fit, Found, Verdict
from experiments.diagnosis_report.numbers import (
    error_unit,
    errors_text,
    estimate_text,
    percent,
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
from experiments.diagnosis_report.pulses import pulse_sentences
from experiments.diagnosis_report.words import effect_words

MANY = 3
"""Places of one effect from which on they are told together."""

SHOWN = 0.01
"""Part of its interval: what is closer to nothing is not shown by the data."""

BADGES = {
    "effects": "missing physics found",
    "none": "nothing missing",
    "unknown": "unknown physics",
    "not_identifiable": "these data cannot tell",
}
"""Each kind of verdict in a few words, where the question is what the sim lacks."""

CHANGE_BADGES = {
    "effects": "changed since the reference",
    "none": "nothing has changed since the reference",
    "unknown": "changed since the reference, by unknown physics",
    "not_identifiable": "these data cannot tell whether anything has changed",
}
"""Each kind of verdict in a few words, where reference recordings of the healthy robot
were given and the question is what has changed since."""


def badge(verdict: Verdict, changed: bool = False) -> str:
    """The kind of a verdict in a few words.

    Args:
      verdict: of the diagnosis.
      changed: whether the question was what has changed since the reference.
    """
    return (CHANGE_BADGES if changed else BADGES)[verdict.kind]


def question(robot: str, changed: bool) -> str:
    """The question that a diagnosis answers.

    Args:
      robot: its name or its model file.
      changed: whether reference recordings were given.
    """
    if changed:
        return f"What has changed about {robot} since the reference recordings?"
    return f"What does the sim of {robot} lack that its recordings show?"


def answer(verdict: Verdict, changed: bool = False) -> list[str]:
    """The answer in one to a few sentences, the most important first.

    Args:
      verdict: of the diagnosis.
      changed: whether the question was what has changed.
    """
    pulses = [*map(sentence, pulse_sentences(verdict.pulses))]
    if verdict.kind == "none":
        return [*_nothing(verdict, changed), *pulses]
    first, before = list[str](), ""
    if verdict.kind == "unknown":
        first, before = _unknown(verdict, changed), "besides, "
    elif verdict.kind == "not_identifiable":
        first, before = _open(verdict, changed), "this much is sure: "
    found = [before + each for each in findings(verdict.effects, changed)]
    return [*first, *map(sentence, found), *pulses, *_gain(verdict)]


def findings(effects: Sequence[Found], changed: bool = False) -> list[str]:
    """A clause for each effect; one for all places of an effect that is at many.

    Args:
      effects: the surest first.
      changed: whether the question was what has changed.
    """
    return [
        at_many(group) if len(group) > 1 else finding(group[0], changed)
        for group in told_together(effects)
    ]


def told_together(effects: Sequence[Found]) -> list[list[Found]]:
    """Effects in their order, each alone or with all that are alike at other places."""
    groups: dict[str, list[Found]] = {}
    for effect in effects:
        alike = [one for one in effects if one.name == effect.name]
        many = len(alike) >= MANY and all(
            one.when.kind == "always" and one.parameters for one in alike
        )
        key = effect.name if many else f"{effect.name}@{effect.place}"
        groups.setdefault(key, []).append(effect)
    return [*groups.values()]


def at_many(alike: Sequence[Found]) -> str:
    """Least and most of an effect's first value, and where they are."""
    name = next(iter(alike[0].parameters))
    order = sorted(alike, key=lambda one: one.parameters[name].value)

    def value(effect: Found) -> str:
        one = effect.parameters[name]
        alone = estimate_text(replace(one, low=one.value, high=one.value))
        return f"about {alone} at {place_words(effect.place)}"

    return (
        f"{effect_words(alike[0].name).label} at {len(alike)} places, "
        f"{name.replace('_', ' ')} from {value(order[0])} to {value(order[-1])}"
    )


def finding(effect: Found, changed: bool = False) -> str:
    """A clause: "the left knee (LKneePitch) has play of about 0.030 rad (...) ..."."""
    words = effect_words(effect.name)
    numbers = {
        name: f"about {estimate_text(one)}"
        for name, one in effect.parameters.items()
        if abs(one.value) > SHOWN * (one.high - one.low)
    }
    clause = words.finding.format_map(
        _Words(
            numbers,
            joint=place_words(effect.place),
            body=place_words(effect.place, "body"),
            lacking="that was not there before" if changed else "that the sim lacks",
            usual="before" if changed else "in the sim",
        )
    )
    course, start_s, end_s = effect.when.kind, effect.when.start_s, effect.when.end_s
    if course == "always":
        return clause
    doing = "from" if course == "burst" else "growing from"
    return f"{clause}, {doing} {start_s:.3g} to {end_s:.3g} s"


class _Words(dict[str, str]):
    """Words for a template; a parameter that the data do not show is unknown."""

    def __init__(self, numbers: dict[str, str], **words: str) -> None:
        super().__init__(numbers | words)

    def __missing__(self, key: str) -> str:
        return "an unknown amount"


class Headline(NamedTuple):
    """Held-out errors of the channel that the nominal sim misses most, as texts."""

    channel: str
    nominal: str
    corrected: str
    floor: str
    unit: str


def headline(fit: Fit | None) -> Headline | None:
    """The errors to tell first; None where nothing was kept out."""
    if fit is None or not fit.channels:
        return None
    name, worst = max(fit.channels.items(), key=lambda item: item[1].excess)
    errors = (worst.nominal, worst.corrected, worst.floor)
    factor, unit = error_unit(worst.unit, max(errors))
    nominal, corrected, floor = errors_text(factor * error for error in errors)
    return Headline(channel_words(name), nominal, corrected, floor, unit)


def _gain(verdict: Verdict) -> list[str]:
    """Before and after, if anything was corrected."""
    errors, fit = headline(verdict.fit), verdict.fit
    if errors is None or fit is None or not verdict.effects:
        return []
    one = "it" if len(verdict.effects) == 1 else "these"
    closed = fit.closed(fit.corrected)
    over_all = (
        ""
        if closed is None
        else f" Over all channels, {percent(min(max(closed, 0.0), 1.0))} of the error "
        "above the noise is gone."
    )
    return [
        f"With {one} the sim's error in {errors.channel}, on recordings that were kept "
        f"out, falls from {errors.nominal} to {errors.corrected} {errors.unit}; noise "
        f"alone makes {errors.floor}.{over_all}"
    ]


def _nothing(verdict: Verdict, changed: bool) -> list[str]:
    what = "has changed" if changed else "is missing"
    lines = [f"Nothing {what} that these recordings could show."]
    errors = headline(verdict.fit)
    if errors:
        lines.append(
            f"Even where it is largest, in {errors.channel}, the sim's error on "
            f"recordings that were kept out is {errors.nominal} {errors.unit}; noise "
            f"alone makes {errors.floor}."
        )
    if verdict.smallest_detectable:
        lines.append("Smaller effects may be there; how small is said below.")
    return lines


def _unknown(verdict: Verdict, changed: bool) -> list[str]:
    what = "has changed" if changed else "is missing"
    lines = [f"Something {what} that no effect known here explains."]
    rest = verdict.unexplained
    if rest is not None:
        lines.append(
            f"{percent(rest.share)} of the squared error above the noise is left, most "
            f"of it in {channel_words(rest.channel)}; its shape is shown below."
        )
    return lines


def _open(verdict: Verdict, changed: bool) -> list[str]:
    if not verdict.alternatives:
        what = "has changed" if changed else "is missing"
        return [
            f"These recordings cannot tell whether anything {what}.",
            verdict.limits[0],
        ]
    if len(verdict.alternatives) == 1:
        hint = answer_words(verdict.alternatives[0])
        return [f"These recordings hint at {hint}, but do not confirm it."]
    return [
        "Something differs, but these recordings fit several explanations equally "
        f"well: {choice(verdict.alternatives)}."
    ]


def doubts(verdict: Verdict) -> list[str]:
    """What else could be so, and how sure the answer is."""
    lines = []
    for effect in verdict.effects:
        sure = f"{at_words(effect)}: {percent(effect.probability)} sure"
        others = [at_words(other) for other in effect.confusable_with]
        if others:
            sure += f"; the recordings do not rule out {listing(others, 'or')} instead"
        else:
            sure += "; no other effect known here explains the recordings as well"
        lines.append(sentence(sure))
    answers = [answer_words(one) for one in verdict.alternatives]
    if answers and verdict.kind != "not_identifiable":
        lines.append(f"Other answers that fit about as well: {listing(answers, 'or')}.")
    return lines


def next_step(verdict: Verdict) -> str:
    """The experiment that would tell most; empty if there is none."""
    step = verdict.next_experiment
    if step is None:
        return ""
    joint = f" of {place_words(step.joint)}" if step.joint else ""
    return f"Record {step.motion}{joint}: {step.why.rstrip('.')}."


def parameter_rows(effect: Found) -> list[tuple[str, str]]:
    """Names and values of an effect's parameters."""
    return [
        (name.replace("_", " "), estimate_text(one))
        for name, one in effect.parameters.items()
    ]
