"""Looks for torques that ripple with the angles of joints, before any is simulated.

The torque that the motion needs, less the one that the motors gave, is compared with
waves over the angle of each joint, of all lengths that fit into its range: a
periodogram by least squares (Lomb 1976), beside what else goes with a joint's motion.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from diagnosis.effects.ripple import MOST_PER_TURN
from diagnosis.plant.loads import model_under
from diagnosis.plant.plant import Plant, inverse_dynamics
from diagnosis.replay.asked import centred
from diagnosis.residuals.predictor import Predictor
from diagnosis.traces.smoothing import smooth_columns
from diagnosis.traces.trace import Trace
from diagnosis.traces.usage import Ripple, Usage
from groundwalk.arrays import FloatArray

TRIED = 2
"""Most ripples that are tried at a joint: the one that shows most, and another one that
the first may hide."""

FINER = 4
"""Waves per turn that are tried, for one that can be told from its neighbour."""

LEAST_ROWS = 4
"""Fewest rows of a wave at a joint's rms speed: shorter waves are not seen."""

SIGN_RAD_S = 0.02
"""Speed at which dry friction is 76 % of itself in what goes with motion."""


def usage_of(predictor: Predictor) -> Usage:
    """How joints are used in a predictor's recordings, and which ripples they show."""
    plant, traces = predictor.plant, predictor.traces
    usage = Usage.of(plant, traces)
    return replace(usage, ripples=ripples(plant, traces))


def ripples(plant: Plant, traces: Sequence[Trace]) -> dict[str, tuple[Ripple, ...]]:
    """The ripples that recordings show most at each joint, the largest first.

    None at joints that turn by less than a wave, or whose torques are not known, and
    none of a floating base, whose motion contacts drive.
    """
    if plant.base == "floating":
        return {}
    parts = [_moved(plant, trace) for trace in traces]
    tick_s = float(np.median([trace.tick_s for trace in traces]))
    q, v, a, missing = (np.concatenate(one) for one in zip(*parts, strict=True))
    found = {}
    for j, joint in enumerate(plant.joints):
        own = np.isfinite(q[:, j]) & np.isfinite(missing[:, j])
        columns = (q[own, j], v[own, j], a[own, j])
        found[joint] = _most_shown(columns, missing[own, j], tick_s)
    return found


def _moved(
    plant: Plant, trace: Trace
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """(T, j) positions, speeds, accelerations, and torques that the motors lack."""
    motion = trace.motion
    if motion is None:
        q, v, a = smooth_columns(trace.time_s, trace.position_rad)
    else:
        q, v = motion.position_rad, motion.velocity_rad_s
        a = motion.acceleration_rad_s2
    needed = inverse_dynamics(
        plant, model_under(plant, trace.loads), *map(np.nan_to_num, (q, v, a))
    )
    given = np.full_like(needed, np.nan)
    if motion is None and trace.command_rad is not None:
        given = trace.servo.torque(centred(trace) - q, v)
    elif trace.torque_nm is not None:
        given = trace.torque_nm
    return q, v, a, needed - given


def _most_shown(
    motion: tuple[FloatArray, FloatArray, FloatArray],
    missing: FloatArray,
    tick_s: float,
) -> tuple[Ripple, ...]:
    """The ripples that explain most of (rows,) torques, at one joint.

    Its motion are angles, speeds and accelerations (rows,).
    """
    q, v, a = motion
    reach = float(np.ptp(q)) if len(q) else 0.0
    speed = float(np.sqrt(np.mean(v**2))) if len(q) else 0.0
    if reach <= 0 or speed <= 0:
        return ()
    lowest = 2 * np.pi / reach
    highest = min(2 * np.pi / (LEAST_ROWS * speed * tick_s), MOST_PER_TURN)
    waves = np.arange(max(lowest, 1.0), highest, lowest / FINER)
    if len(waves) < FINER or len(q) < 10 * LEAST_ROWS:
        return ()
    beside = np.stack([np.ones_like(q), q, v, np.tanh(v / SIGN_RAD_S), a], axis=1)
    basis, _ = np.linalg.qr(beside)
    left = missing - basis @ (basis.T @ missing)
    tried = [_of(wave, q, basis, left) for wave in waves]
    gains = np.array([gain for gain, _ in tried])
    chosen: list[int] = []
    for i in np.argsort(-gains).tolist():
        if all(abs(waves[i] - waves[other]) >= lowest for other in chosen):
            chosen.append(i)
        if len(chosen) == TRIED:
            break
    return tuple(tried[i][1] for i in chosen)


def _of(
    wave: float, q: FloatArray, basis: FloatArray, left: FloatArray
) -> tuple[float, Ripple]:
    """By how much waves over the angle lower the sum of squares, and their ripple."""
    both = np.stack([np.sin(wave * q), np.cos(wave * q)], axis=1)
    both = both - basis @ (basis.T @ both)
    (sine, cosine), *_ = np.linalg.lstsq(both, left, rcond=1e-6)
    gain = float(left @ (both @ np.array([sine, cosine])))
    size, phase = float(np.hypot(sine, cosine)), float(np.arctan2(cosine, sine))
    return gain, (size, float(wave), phase)
