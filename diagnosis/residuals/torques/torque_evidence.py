"""Decides whether torques or motions are compared, and smooths motions for torques.

Where measured torques drive a robot's joints in a replay, errors grow from step to
step: a friction that the model lacks soon moves it far from the recorded motion, and
then whatever hinders a joint from moving fits better. The torque that the recorded
motion needs is compared with the measured one instead: it has no such memory, and says
at each moment which joint lacks how much.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from diagnosis.plant.loads import model_under
from diagnosis.plant.plant import Plant, inverse_dynamics
from diagnosis.residuals.channels import LEAST_TORQUE
from diagnosis.residuals.predictor import Predictor
from diagnosis.traces.motion import Motion
from diagnosis.traces.noise import noise_of
from diagnosis.traces.smoothing import Smoothed, smooth_below
from diagnosis.traces.split import shortened
from diagnosis.traces.trace import Trace
from groundwalk.arrays import BoolArray, FloatArray

COMPARED = (
    "{why}: the torques that the recorded motion needs are compared with the measured "
    "ones, at joints that move"
)
UNKNOWN = "no servo is known that drove the joints"
STRAYS = "a replay of the measured torques leaves the recorded motion within 0.5 s"
"""Sentence for the report on the evidence where torques are compared, and reasons."""

FAR = 0.4
"""Distance of a replay from the recorded motion, as a share of a joint's range in the
recording, in 5 % of the rows, from which on it says nothing about that motion."""

HIGHEST = 0.25
"""Highest cut-off frequency, as a share of the sampling rate: accelerations of faster
motion are not measured."""

FINER = 1.5
"""Ratio of successive cut-off frequencies that are tried."""

WORSE = 0.01
"""Share by which the unexplained torque may exceed that of the best cut-off, for a
higher cut-off to be taken, which loses less of the motion."""

LEAST_ROWS = 40
"""Fewest rows of the recordings that one period of the lowest cut-off tried has not to
exceed: slower motion would be smoothed away from the recordings' parts."""

SHARE = 0.125
"""Longest duration of a block, as a share of the period of quick motion."""

ALIKE = 0.5
"""Correlation of the mean torques, left by regression, of successive blocks from which
on blocks are joined."""

SLOW = 0.15
"""Speed, as a share of a joint's rms speed, below which the sign of dry friction may
not be that of the speed, since a gear winds up before it turns."""

SURE = 4.0
"""Standard deviations of the speed's noise that a speed must exceed for a sign."""

CHOSEN_S = 30.0
"""Most seconds of the recordings on which the cut-off is chosen."""

SEED = 20_260_102
"""Seed of the noise that is sent through the smoothing; always the same."""


def torques_tell(plant: Plant, traces: Sequence[Trace], held: bool) -> str:
    """Why needed torques are compared with measured ones; "" if motions are compared.

    Torques are compared if the base is fixed, each joint's torque was measured, and
    nothing else is known to have driven the joints: neither torque targets nor, in any
    recording, servos with commands (`held`). If servos are known but measured torques
    are to drive the joints instead, replays of these torques count as long as they stay
    near the recorded motion in short windows.
    """
    if plant.base == "floating" or not all(map(_has_torques, traces)):
        return ""
    if not held:
        return COMPARED.format(why=UNKNOWN)
    return COMPARED.format(why=STRAYS) if _strays(plant, traces) else ""


def _has_torques(trace: Trace) -> bool:
    """Whether measured torques are all that is known to have driven the joints."""
    if not trace.unheld or trace.torque_nm is None:
        return False
    moved = np.nan_to_num(trace.torque_nm).any(axis=0)
    return trace.command_torque_nm is None and bool(moved.all())


def _strays(plant: Plant, traces: Sequence[Trace]) -> bool:
    """Whether replays in the shortest windows leave the recorded motion."""
    some = shortened(traces, CHOSEN_S)
    predictor = Predictor(plant, some)
    noise = predictor.channels.noise[predictor.channel]
    wrong = np.abs(predictor.residuals([()])[0] * noise)
    joints, channels = len(plant.joints), len(predictor.channels.names)
    wrong = wrong.reshape(-1, channels)[:, :joints]
    position = np.concatenate([trace.position_rad for trace in some])
    reach = np.nanmax(position, axis=0) - np.nanmin(position, axis=0)
    far = wrong / np.maximum(reach, 1e-9)
    return bool((np.quantile(far, 0.95, axis=0) > FAR).any())


def with_used_torques(plant: Plant, traces: Sequence[Trace]) -> Plant:
    """The plant, with the largest torques of traces that all have measured torques."""
    torques = [one.torque_nm for one in traces if one.torque_nm is not None]
    used_nm = np.abs(np.nan_to_num(np.concatenate(torques))).max(axis=0)
    return replace(plant, used_nm=used_nm)


def with_motions(
    plant: Plant, traces: Sequence[Trace], least_s: float = 0.0
) -> list[Trace]:
    """The traces, with the smoothed motions from which needed torques follow.

    Motions are smoothed below one cut-off frequency, see `cutoff_hz`. Torques will be
    averaged over blocks of rows, see `block_s`, of `least_s` at least. All traces have
    measured torques.
    """
    some = shortened(traces, CHOSEN_S)
    highest_hz = cutoff_hz(plant, some)
    longest_s = max(block_s(plant, some, highest_hz), least_s)
    return [
        replace(one, motion=_motion(plant, one, highest_hz, longest_s))
        for one in traces
    ]


def cutoff_hz(plant: Plant, traces: Sequence[Trace]) -> float:
    """The frequency above which motion is smoothed away, in all recordings alike.

    Smoothing less leaves more noise in accelerations, smoothing more loses motion:
    either way the motion's torque fits the measured torque, whose noise is independent,
    less well. The best cut-off is sought from a quarter of the sampling rate down, and
    of those that do nearly as well the highest one counts.
    """
    rate_hz = 1 / max(trace.tick_s for trace in traces)
    lowest_hz = rate_hz / LEAST_ROWS
    count = int(np.log(HIGHEST * rate_hz / lowest_hz) / np.log(FINER))
    tried = HIGHEST * rate_hz / FINER ** np.arange(count + 1)
    missed = np.array([_missed(plant, traces, one) for one in tried])
    near = missed <= (1 + WORSE) * missed.min()
    return float(tried[near].max())


def block_s(plant: Plant, traces: Sequence[Trace], highest_hz: float) -> float:
    """Duration [s] of blocks of rows whose mean torque counts as one measurement.

    Within half a period of the cut-off the motion hardly changes. Blocks are longer if
    what regression leaves of the torque is alike in successive ones, as no model is
    exact: rows that say the same must not count as several. But they are never so long
    that motion averages out in them.
    """
    found = [smoothed(trace, highest_hz) for trace in traces]
    left = [_regressed(plant, *one) for one in zip(traces, found, strict=True)]
    speed, rate = (
        np.sqrt(np.nanmean(np.concatenate(parts) ** 2, axis=0))
        for parts in ([one.rate for one in found], [one.acceleration for one in found])
    )
    # a sine of w rad/s has accelerations w times its speeds
    quickest_1_s = float(np.max(rate / np.maximum(speed, 1e-12)))
    longest_s = SHARE * 2 * np.pi / max(quickest_1_s, 1e-12)
    length_s = 0.5 / highest_hz
    tick_s = min(trace.tick_s for trace in traces)
    while 2 * length_s <= longest_s and _alike(left, length_s / tick_s) > ALIKE:
        length_s *= 2
    return length_s


def _alike(left: Sequence[FloatArray], rows: float) -> float:
    """Correlation of successive means, over so many rows, of (T, j) torques."""
    pairs = []
    for one in left:
        means = _block_means(np.nan_to_num(one), max(1, int(rows)))
        pairs.append((np.sum(means[1:] * means[:-1], axis=0), np.sum(means**2, axis=0)))
    products, squares = np.sum(pairs, axis=0)
    return float(np.mean(products / np.maximum(squares, 1e-12)))


def _missed(plant: Plant, traces: Sequence[Trace], highest_hz: float) -> float:
    """Mean squared torque that regression on a smoothed motion leaves, noise being 1.

    See `_regressed`: usual missing physics does not disturb the choice of a cut-off.
    """
    total = rows = 0.0
    for trace in traces:
        found = smoothed(trace, highest_hz)
        left = _regressed(plant, trace, found)
        noise = np.array([_torque_noise(trace, j) for j in range(left.shape[1])])
        total += float(np.nansum((left / np.maximum(noise, 1e-12)) ** 2))
        rows += float(np.isfinite(left).sum())
    return total / max(rows, 1.0)


def _regressed(plant: Plant, trace: Trace, found: Smoothed) -> FloatArray:
    """(T, j) torque [N m] that regression on a smoothed motion leaves; NaN if unknown.

    Each joint's measured torque, less the nominal model's for the motion, is regressed
    on acceleration, velocity and its sign, and on a constant.
    """
    assert trace.torque_nm is not None
    left = np.full_like(trace.torque_nm, np.nan)
    inside = np.isfinite(trace.position_rad).all(axis=1)
    needed = inverse_dynamics(
        plant, model_under(plant, trace.loads), *map(np.nan_to_num, found)
    )
    for j, measured in enumerate(trace.torque_nm.T):
        known, v = inside & np.isfinite(measured), found.rate[:, j]
        if known.any():
            way = np.tanh(v / (SLOW * np.std(v[known]) + 1e-12))
            columns = found.acceleration[:, j], v, way, np.ones(len(v))
            design = np.stack(columns, axis=1)[known]
            target = (measured - needed[:, j])[known]
            size = np.linalg.lstsq(design, target, rcond=None)[0]
            left[known, j] = target - design @ size
    return left


def smoothed(trace: Trace, highest_hz: float) -> Smoothed:
    """(T, j) positions, velocities and accelerations below a frequency."""
    columns = [
        smooth_below(trace.time_s, one, highest_hz) for one in trace.position_rad.T
    ]
    return Smoothed(*(np.stack(parts, axis=1) for parts in zip(*columns, strict=True)))


def _motion(plant: Plant, trace: Trace, highest_hz: float, block_s: float) -> Motion:
    """The smoothed motion of a recording, and the noise of torques that it leaves."""
    rows = max(1, int(block_s / trace.tick_s + 1e-9))
    found = smoothed(trace, highest_hz)
    again = smoothed(_noisier(trace, found.value), highest_hz)
    position, velocity, acceleration = map(np.nan_to_num, found)
    inside = _inside(trace, 1 / highest_hz)
    before, after = (
        inverse_dynamics(
            plant, model_under(plant, trace.loads), *map(np.nan_to_num, one)
        )
        for one in (found, again)
    )
    wrong = _block_means((after - before)[inside], rows)
    by_motion = np.sqrt(np.mean(wrong**2, axis=0)) if len(wrong) else 0.0
    each = range(len(plant.joints))
    by_torque = np.array([_torque_noise(trace, j) for j in each]) / np.sqrt(rows)
    least = LEAST_TORQUE * _rms(trace.torque_nm)
    wobble = np.std((again.rate - found.rate)[inside], axis=0) if inside.any() else 0.0
    speed = np.sqrt(np.mean(velocity**2, axis=0))
    slowest = np.maximum(SLOW * speed, SURE * np.nan_to_num(wobble))
    counts = (np.abs(velocity) > slowest) & inside[:, None]
    noise = np.maximum(np.hypot(by_motion, by_torque), least)
    rest = np.where(counts, _regressed(plant, trace, found), np.nan)
    left = _rms(_block_means(rest, rows))
    return Motion(position, velocity, acceleration, counts, rows, noise, left)


def _noisier(trace: Trace, position_rad: FloatArray) -> Trace:
    """The trace with (T, j) smooth positions plus noise of the measured ones' size."""
    noise = [noise_of(trace.time_s, one).total for one in trace.position_rad.T]
    wrong = np.random.default_rng(SEED).standard_normal(position_rad.shape) * noise
    return replace(trace, position_rad=position_rad + wrong)


def _inside(trace: Trace, edge_s: float) -> BoolArray:
    """(T,) whether all positions of a row are known, and it is not at either end."""
    since_s = trace.time_s - trace.time_s[0]
    inner = (since_s >= edge_s) & (since_s <= since_s[-1] - edge_s)
    return np.asarray(inner & np.isfinite(trace.position_rad).all(axis=1))


def _torque_noise(trace: Trace, joint: int) -> float:
    """Standard deviation [N m] of the noise of one joint's measured torque."""
    assert trace.torque_nm is not None
    return noise_of(trace.time_s, trace.torque_nm[:, joint]).total


def _rms(values: FloatArray | None) -> FloatArray:
    """(j,) root mean squares of the values (T, j) that are known; 0 if none is."""
    assert values is not None
    known = np.isfinite(values)
    squares = np.where(known, values, 0.0) ** 2
    return np.asarray(np.sqrt(squares.sum(axis=0) / np.maximum(known.sum(axis=0), 1)))


def _block_means(values: FloatArray, rows: int) -> FloatArray:
    """(blocks, j) means of whole blocks of successive rows of (T, j) values."""
    whole = len(values) // rows * rows
    return np.asarray(values[:whole].reshape(-1, rows, values.shape[1]).mean(axis=1))
