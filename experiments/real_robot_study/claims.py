"""Claims on the report page about the diagnosis of a real robot; whether they hold."""

from collections.abc import Iterator

from diagnosis import Verdict
from diagnosis.verdict import Pulse
from experiments.diagnosis_report.findings import pulse_sentences
from experiments.diagnosis_report.numbers import estimate_text
from experiments.real_robot_study.cases import RealRobot
from experiments.transfer.claims import Claim

TWICE = 2.0
"""Least factor by which the effects found must reduce held-out errors, as claimed."""


def claims_of(robot: RealRobot, verdict: Verdict) -> list[Claim]:
    """All claims about a robot's diagnosis, each with whether it holds.

    Example:
      >>> claims_of(ROBOTS["emps"], verdict)[0].holds
      True
    """
    claims = list(_published(robot, verdict))
    if robot.pulses:
        claims.append(_pulses(robot.pulses, verdict.pulses))
    if robot.twice:
        claims.append(_twice(verdict))
    if robot.sane:
        claims.append(_sane(robot, verdict))
    return claims


def sane_bounds(robot: RealRobot, effect: str, parameter: str) -> str:
    """The plausible range of a parameter as text; "" if none is known."""
    bounds = (robot.sane or {}).get(f"{effect}.{parameter}")
    return f"{bounds.low:g} to {bounds.high:g}: {bounds.why}" if bounds else ""


def _published(robot: RealRobot, verdict: Verdict) -> Iterator[Claim]:
    """Yield for each published value the claim that the verdict's interval holds it."""
    for known in robot.published:
        own = [one.parameters for one in verdict.effects if one.name == known.effect]
        found = next(
            (one[known.parameter] for one in own if known.parameter in one), None
        )
        text = f"{known.text}: the 80 % interval holds the published {known.value:g}"
        holds = found is not None and found.low <= known.value <= found.high
        yield Claim(text, holds, estimate_text(found) if found else "not found")


def _pulses(count: int, pulses: tuple[Pulse, ...]) -> Claim:
    """The claim that `count` pulses were found, all at the actuator's input."""
    text = f"all {count} pulses are located and attributed to the actuator's input"
    right = [pulse for pulse in pulses if pulse.source == "actuator input"]
    found = "; ".join(pulse_sentences(pulses)) or "none found"
    return Claim(text, len(right) == len(pulses) == count, found)


def _twice(verdict: Verdict) -> Claim:
    """The claim that the effects found at least halve the error of held-out motions."""
    text = "held-out motions are predicted at least twice as well"
    if verdict.fit is None:
        return Claim(text, False, "nothing was held out")
    fit = verdict.fit
    ratios = {
        name.partition(".")[2]: one.nominal / one.corrected
        for name, one in fit.channels.items()
    }
    joints = ", ".join(f"{name} {ratio:.1f}" for name, ratio in ratios.items())
    ratio = fit.nominal / fit.corrected
    return Claim(text, ratio >= TWICE, f"{ratio:.1f} times in all; {joints}")


def _sane(robot: RealRobot, verdict: Verdict) -> Claim:
    """The claim that each joint has an effect, and that all values are plausible."""
    text = "an effect is named at each joint, and all values are possible"
    joints = [
        name.partition(".")[2]
        for name in (verdict.fit.channels if verdict.fit else ())
        if name.startswith("position.")
    ]
    places = {effect.place for effect in verdict.effects}
    wrong = [f"nothing at {joint}" for joint in joints if joint not in places]
    for effect in verdict.effects:
        for name, value in effect.parameters.items():
            bounds = (robot.sane or {}).get(f"{effect.name}.{name}")
            if bounds and not bounds.low <= value.value <= bounds.high:
                wrong.append(f"{effect.name}@{effect.place} {value.value:.3g}")
    count = len(verdict.effects)
    return Claim(text, not wrong, "; ".join(wrong) or f"{count} effects, all possible")
