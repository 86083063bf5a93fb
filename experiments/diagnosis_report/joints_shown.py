"""The report's section on what each joint shows: its table, sentences and figures."""

from collections.abc import Sequence
from typing import Any

from diagnosis import Diagnosis, Trace, Verdict
from diagnosis.seen import Delay, Seen, SeenJoint, Share, look
from diagnosis.seen.drivers import OTHERS
from experiments.diagnosis_report.figure_style import inline_svg, slim
from experiments.diagnosis_report.findings import finding
from experiments.diagnosis_report.joint_figures import NOTHING, joint_figure
from experiments.diagnosis_report.numbers import DASH, percent, sure_text
from experiments.diagnosis_report.place_words import at_words, listing, sentence
from experiments.diagnosis_report.text import next_step

MOST_FIGURES = 8
"""Largest number of joints that are drawn; the table has all."""

MOST_NAMED = 6
"""Largest number of joints that a sentence names."""

BY_CHANCE = 0.03
"""Share below which the table names no quantity: the best of several may have as much
by chance."""

CLEARLY = 0.1
"""Share by which other joints must explain more than a joint's own motion."""

SOURCES = {
    "measured": "measured",
    "servo": "servo's gains",
    "target": "torque target",
    "passive": "nothing drives it",
    "unknown": "not known",
}
"""Words for where a joint's torque is known from."""

READ = (
    "How to read it: dry friction jumps at zero speed and is level beside it, viscous "
    "friction is a slope, and so are late commands. Friction that grows with load "
    "opens over the load; a wrong mass, a spring or a cable tilts or bends both "
    "directions alike over position. A joint that winds up before it slides needs some "
    "travel after a turn. Bars, grey: the share of the loss torque's variance that a "
    "quantity explains by itself, in parts of the recordings that were not used. "
    "Dark: what no other quantity explains. Joints that move together explain each "
    "other's loss torque; then only dark tells. Dotted: the most that could be "
    "explained, as far as like motions came with like torques. The dashes through the "
    "tracking errors are what the declared stiffness says."
)
"""The explanation below the figures."""


def look_at(found: Diagnosis, traces: Sequence[Trace]) -> Seen:
    """What each joint shows in recordings, with the law of the verdict's effects."""
    told = {
        (one.name, place)
        for one in found.verdict.effects
        for place in (one.place, *one.shared_with)
    }
    model = tuple(one for one in found.model if (one.name, one.place) in told)
    return look(found.plant, traces, model)


def joints_shown(seen: Seen, verdict: Verdict) -> dict[str, Any]:
    """What the page's template shows of all joints, and of what was found at each."""
    drawn = [one for one in seen.joints if one.curves]
    largest = sorted(drawn, key=lambda one: -(one.loss_rms or 0.0))[:MOST_FIGURES]
    names = {one.joint for one in largest}
    return {
        "what": _what(seen),
        "rows": [_row(one) for one in seen.joints],
        "unknown": _unknown(seen),
        "figures": [
            {
                "name": _title(one),
                "svg": _svg(one, f"joint{k}"),
                "found": _found_at(one.joint, verdict),
            }
            for k, one in enumerate(seen.joints)
            if one.joint in names
        ],
        "left_out": len(drawn) - len(largest),
        "read": READ if drawn else "",
    }


def _found_at(joint: str, verdict: Verdict) -> list[str]:
    """Sentences on what was found at a joint, or that nothing was, and what would tell.

    A joint without a finding of its own may move the body that has one.
    """
    own = [
        one
        for one in verdict.effects
        if joint in (one.place, *one.shared_with) and one.when.recording is None
    ]
    lines = []
    for one in own:
        others = [at_words(other) for other in one.confusable_with]
        instead = f"; it may be {listing(others, 'or')} instead" if others else ""
        said = f"{finding(one)}: {sure_text(one.probability)}{instead}"
        lines.append(sentence(said))
    step = verdict.next_experiment
    if step is not None and step.joint == joint:
        lines.append(f"What would tell: {next_step(verdict)}")
    return lines or ["No effect was found at this joint itself."]


def _what(seen: Seen) -> str:
    """What loss torque and bands are, or that no loss torque is known."""
    if seen.cutoff_hz is None:
        return (
            "The torques that these joints had, or those that their motion needs, are "
            "not known: only how late the joints follow their commands is shown."
        )
    each = f"{len(seen.pieces)} recordings"
    if seen.by == "blocks":
        each = f"{len(seen.pieces)} parts of the recordings, equal in time"
    return (
        "Before any effect is named, and without a fit: the loss torque is the torque "
        "that a joint had, less the torque that its motion needs by the nominal "
        f"model, below {seen.cutoff_hz:.2g} Hz. If nothing is missing, it is noise. "
        f"Lines are medians over {each}, bands 10 to 90 % of them."
    )


def _row(joint: SeenJoint) -> dict[str, str]:
    unit = joint.torque_unit
    return {
        "joint": joint.joint,
        "source": SOURCES[joint.source],
        "loss": _torque(joint.loss_rms, unit),
        "needed": _torque(joint.needed_rms, unit),
        "most": _most(joint),
        "together": DASH if joint.together is None else _share(joint.together),
        "noise": DASH if joint.noise_share is None else _share(joint.noise_share),
        "delay": _delay(joint.delay),
    }


def _most(joint: SeenJoint) -> str:
    """The quantity that explains most by itself, and its share.

    Joints often move together, so others must explain clearly more to be named.
    """
    if not joint.shares:
        return DASH

    def told(one: Share) -> float:
        return one.alone - CLEARLY * (one.name == OTHERS)

    best = max(joint.shares, key=told)
    if best.alone < BY_CHANCE:
        return "nothing"
    return f"{best.name} ({percent(best.alone)})"


def _share(share: float) -> str:
    return percent(share) if share >= NOTHING else "nothing"


def _torque(size: float | None, unit: str) -> str:
    return DASH if size is None else f"{size:.2g} {unit}"


def _delay(delay: Delay | None) -> str:
    """A delay with its spread, such as "44 ms (42 to 46)"."""
    if delay is None:
        return DASH
    middle, low, high = (
        f"{1e3 * one:.3g}" for one in (delay.middle_s, delay.low_s, delay.high_s)
    )
    return f"{middle} ms ({low} to {high})"


def _unknown(seen: Seen) -> list[str]:
    """What is not known, each sentence once, with the joints that it is about."""
    sentences = dict.fromkeys(text for one in seen.joints for text in one.unknown)
    lines = []
    for text in sentences:
        names = [one.joint for one in seen.joints if text in one.unknown]
        more = len(names) - MOST_NAMED
        if more > 1:
            names = [*names[:MOST_NAMED], f"{more} more joints"]
        lines.append(f"{listing(names, 'and')}: {text}")
    return lines


def _title(joint: SeenJoint) -> str:
    return f"{joint.joint}: loss torque {_torque(joint.loss_rms, joint.torque_unit)}"


def _svg(joint: SeenJoint, name: str) -> str:
    alternative = f"loss torque of {joint.joint} over speed, load and position"
    return slim(inline_svg(joint_figure(joint), name, alternative))
