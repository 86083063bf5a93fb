"""Checks recordings before anything is fitted: what can they show, and what not?"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from diagnosis.audit.audit import audit
from diagnosis.check.evidence import LEAST_S, Sizes, evidence_of, tries_of
from diagnosis.check.next_motions import next_motions
from diagnosis.check.result import Alike, Check, Size
from diagnosis.check.variety import lacking, why_alike
from diagnosis.conclude.smallest_sizes import Smallest
from diagnosis.effects.library import all_effects, effect
from diagnosis.effects.parts import Variety
from diagnosis.material import Material
from diagnosis.plant.plant import Plant
from diagnosis.residuals.channels import Channels, channel_unit
from diagnosis.residuals.data_sets import affordable
from diagnosis.residuals.predictor import Predictor
from diagnosis.residuals.torques.torque_predictor import predictor_of
from diagnosis.traces.outliers import without_outliers
from diagnosis.traces.reference import Reference
from diagnosis.traces.split import shortened, split, thinned
from diagnosis.traces.trace import DriveBy, Trace
from diagnosis.verdict import Amount
from groundwalk.blas import one_blas_thread
from groundwalk.errors import BadRecordingError, BadValueError

SIMULATED_S = 8.0
"""Most seconds of the recordings that are simulated with effects, the liveliest part of
each; what they show grows with the time."""

TWINS = "no recording of this robot tells more than that one of the two is there"
"""Why an effect and its twin are not told apart, see `Effect.twins`."""

FAR_APART = 2.0
"""Two effects count as alike if one is told only at this multiple of the size at which
it is seen, or never."""


@one_blas_thread
def check(
    plant: Plant,
    traces: Sequence[Trace],
    reference: Reference | None = None,
    drive: DriveBy = "servos",
    threads: int = 1,
    most_rad_s: float | None = None,
) -> Check:
    """Find out what recordings of a robot can show, and what to record next.

    Sizes hold for a robot whose model is right but for small mismatch and one effect:
    where more is wrong, they are larger. With a reference they are those of single
    effects beside small mismatch as well, which is known better then.

    Args:
      plant: nominal robot model.
      traces: recordings of the robot.
      reference: recordings of the healthy robot, with its model then; None without.
      drive: what drives the joints in replays, see `diagnose`.
      threads: number of threads that simulate.
      most_rad_s: highest speed of proposed motions; None for that of the model.

    Raises:
      BadRecordingError: a recording lacks torques that are to drive the joints, or all
        are too short to be divided.

    Example:
      >>> plant, traces = read_traces(["a.parquet"], "so101")
      >>> check(plant, traces).size("coulomb_friction@elbow_flex").told
    """
    try:
        material = Material.of(plant, traces, reference, drive)
    except BadRecordingError:
        audited = audit(traces, plant, reference.traces if reference else ())
        if not audited.refused:
            raise
        return Check(audited, {}, (), (), (), None)
    plant, channels, audited = material.plant, material.channels, material.audited
    now, off = _sizes(plant, material.traces, channels, threads)
    sizes = tuple(_size(plant, one) for one in _in_order(plant, now.smallest))
    clean = [without_outliers(trace)[0] for trace in traces]
    alike = _alike(plant, now.smallest, lacking(plant, clean, audited), audited.moving)
    found = Check(
        audited, _noise(plant, channels), sizes, alike, (), now.demand.gain, off,
        material.limits,
    )  # fmt: skip
    why = _no_next(plant, material.traces)
    if why:
        return replace(found, limits=(*found.limits, why))
    try:
        own = plant, material.traces, channels, now, threads, most_rad_s
        return replace(found, proposed=tuple(next_motions(*own)))
    except BadValueError as error:
        return replace(found, limits=(*found.limits, str(error)))


def _sizes(
    plant: Plant, traces: Sequence[Trace], channels: Channels, threads: int
) -> tuple[Sizes, dict[str, float]]:
    """How large effects must be to be told, from the part that would be fitted.

    And by how many times the noise the nominal sim is off there, by channel.
    """
    fit = affordable(plant, split(traces)).fit
    some = thinned(plant, shortened(fit, SIMULATED_S, LEAST_S), len(channels.names))
    lasted_s = [sum(one.duration_s for one in every) for every in (fit, some)]
    predictor = predictor_of(plant, some, channels, threads=threads)
    weight = lasted_s[0] / max(lasted_s[1], 1e-9)
    predictor.correct()
    off = _off(predictor)
    evidence = evidence_of(predictor, tries_of(predictor), max(weight, 1.0))
    return evidence.sizes(sum(trace.ticks for trace in fit)), off


def _off(predictor: Predictor) -> dict[str, float]:
    """By how many times the noise the nominal sim is off in each channel.

    What is wrong with the simulation itself is not the model's: see `correct`.
    """
    (left,) = predictor.residuals([()])
    return {
        name: float(np.sqrt(np.mean(left[own] ** 2)))
        for column, name in enumerate(predictor.channels.names)
        if (own := predictor.scored & (predictor.channel == column)).any()
    }


def _in_order(plant: Plant, found: dict[str, Smallest]) -> list[Smallest]:
    """Sizes in the order of effects, and in the model's order of joints and bodies."""
    names, places = list(all_effects()), [*plant.joints, *plant.bodies]
    places += [one.placed.place for one in found.values()]
    return sorted(
        found.values(),
        key=lambda one: (names.index(one.placed.name), places.index(one.placed.place)),
    )


def _size(plant: Plant, one: Smallest) -> Size:
    kind = effect(one.placed.name)
    every = kind.parameters(plant, one.placed.place)
    below = kind.threshold or not np.isfinite(every[0].neutral)
    is_late = one.seen is not None and one.told != one.seen
    nearest = one.nearest.key if one.nearest is not None and is_late else None
    values = zip((each.name for each in every), one.placed.values, strict=True)
    own = one.placed.name, one.placed.place, one.told, one.seen
    return Size(*own, nearest, one.alike, below, dict(values))


def _alike(
    plant: Plant,
    sizes: dict[str, Smallest],
    lacks: dict[str, tuple[Variety, ...]],
    moving: frozenset[str],
) -> tuple[Alike, ...]:
    """Pairs of effects that are seen, but not told apart; each pair once.

    Twins are told as one. Places that nothing moves are left out: their joints are
    known to be at rest.
    """
    found: dict[frozenset[str], Alike] = {}
    for key, one in sizes.items():
        twins = effect(one.placed.name).twins(plant, one.placed.place)
        for twin in twins if one.told is not None else ():
            pair = frozenset((key, twin.key))
            found.setdefault(pair, Alike(key, twin.key, TWINS))
        if one.nearest is None or one.seen is None or not _is_lost(one):
            continue
        if {one.placed.place, one.nearest.place} & (set(plant.joints) - moving):
            continue
        pair = frozenset((key, one.nearest.key))
        why = why_alike(one.placed, one.nearest, lacks)
        found.setdefault(pair, Alike(key, one.nearest.key, why))
    return tuple(found.values())


def _is_lost(one: Smallest) -> bool:
    if one.told is None:
        return True
    assert one.seen is not None
    values = one.told.value, one.seen.value
    return max(values) > FAR_APART * max(min(values), 1e-12)


def _noise(plant: Plant, channels: Channels) -> dict[str, Amount]:
    pairs = zip(channels.names, channels.floor, strict=True)
    return {name: Amount(float(v), channel_unit(plant, name)) for name, v in pairs}


def _no_next(plant: Plant, traces: Sequence[Trace]) -> str:
    """Why no motions can be proposed; "" if they can."""
    if plant.base == "floating":
        return "motions are proposed for robots with a fixed base only"
    if any(trace.motion is not None or trace.command_rad is None for trace in traces):
        return (
            "no motions are proposed: these recordings have no position commands that "
            "servos of known stiffness follow"
        )
    return ""
