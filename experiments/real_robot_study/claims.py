"""What an answer about a real robot is held against."""

from collections.abc import Iterator

from diagnosis.verdict.verdict import Estimate, Pulse, Verdict
from experiments.diagnosis_report.findings import pulse_sentences
from experiments.diagnosis_report.numbers import estimate_text
from experiments.real_robot_study.cases import Published, RealRobot
from experiments.transfer.claims import Claim

TWICE = 2.0


def claims_of(robot: RealRobot, verdict: Verdict) -> list[Claim]:
    """Everything that can be said of a robot's answer."""
    claims = list(_published(robot, verdict))
    if robot.pulses:
        claims.append(_pulses(robot.pulses, verdict.pulses))
    if robot.twice:
        claims.append(_twice(verdict))
    if robot.sane:
        claims.append(_sane(robot, verdict))
    return claims


def sane_bounds(robot: RealRobot, effect: str, parameter: str) -> str:
    """What is possible, in words; nothing where nothing is known."""
    bounds = (robot.sane or {}).get(f"{effect}.{parameter}")
    return f"{bounds.low:g} to {bounds.high:g}: {bounds.why}" if bounds else ""


def _published(robot: RealRobot, verdict: Verdict) -> Iterator[Claim]:
    """Whether intervals hold what others found."""
    for known in robot.published:
        found = _estimate(verdict, known)
        text = f"{known.text}: the 80 % interval holds the published {known.value:g}"
        if found is None:
            yield Claim(text, False, "not found")
        else:
            holds = found.low <= known.value <= found.high
            yield Claim(text, holds, estimate_text(found))


def _estimate(verdict: Verdict, known: Published) -> Estimate | None:
    for effect in verdict.effects:
        if effect.name == known.effect and known.parameter in effect.parameters:
            return effect.parameters[known.parameter]
    return None


def _pulses(count: int, pulses: tuple[Pulse, ...]) -> Claim:
    """Whether all pulses were found where they came in."""
    text = f"all {count} pulses are located and attributed to the actuator's input"
    right = [pulse for pulse in pulses if pulse.source == "actuator input"]
    found = "; ".join(pulse_sentences(pulses)) or "none found"
    return Claim(text, len(right) == len(pulses) == count, found)


def _twice(verdict: Verdict) -> Claim:
    """Whether motions that no fit has seen are predicted twice as well."""
    text = "motions kept out of the fit are predicted at least twice as well"
    if verdict.fit is None:
        return Claim(text, False, "nothing was kept out")
    fit = verdict.fit
    ratios = {
        name.partition(".")[2]: one.nominal / one.corrected
        for name, one in fit.channels.items()
    }
    joints = ", ".join(f"{name} {ratio:.1f}" for name, ratio in ratios.items())
    ratio = fit.nominal / fit.corrected
    return Claim(text, ratio >= TWICE, f"{ratio:.1f} times in all; {joints}")


def _sane(robot: RealRobot, verdict: Verdict) -> Claim:
    """Whether all values are possible for such hardware."""
    text = "what is missing is named at each joint, with values that are possible"
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
