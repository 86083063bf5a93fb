"""Baseline: sparse regression of the joint torque that the nominal model lacks."""

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.baselines.found import NORMAL_80, found_effect, verdict_of
from diagnosis.effects.effect import Effect
from diagnosis.effects.library import all_effects, effect
from diagnosis.effects.parts import JointMotion, PlacedEffect
from diagnosis.plant.plant import Plant, inverse_dynamics
from diagnosis.replay.inverse import model_with
from diagnosis.residuals.replays import variants_of
from diagnosis.traces.reference import Reference
from diagnosis.traces.smoothing import smooth_columns
from diagnosis.traces.trace import Trace
from diagnosis.verdict import Verdict
from groundwalk.arrays import FloatArray, IntArray

MOST_ROWS = 1500
"""Largest number of rows, of all recordings together, that regression uses."""

NUDGE_RAD = 1e-4
"""Step of an angle [rad] for finite differences of inverse dynamics."""

_EDGE_S = 0.2
"""Time at both ends of a recording that is left out, because smoothed accelerations are
poor there [s]."""


@dataclass(frozen=True, eq=False)
class Torques:
    """The torque that the nominal model does not explain, in R rows of all recordings.

    Attributes:
      motion: smoothed motion, arrays (R, j); its torque is that of the nominal model.
      damping_nm_s_rad: (j,) median damping plus back-EMF of the servos.
      weight_rad_nm: (j,) weights 1 / kp. They turn torques into position errors, which
        are about equally large at all joints.
      missing: (R j,) weighted torque of the servos less that of the nominal model.
    """

    motion: JointMotion
    damping_nm_s_rad: FloatArray
    weight_rad_nm: FloatArray
    missing: FloatArray

    @classmethod
    def of(cls, plant: Plant, traces: Sequence[Trace]) -> "Torques":
        """Compute servo torque minus inverse dynamics for recordings of a robot."""
        every = max(1, -(-sum(trace.ticks for trace in traces) // MOST_ROWS))
        parts = zip(*(_rows(trace, every) for trace in traces), strict=True)
        t, q, v, a, command, rate, kp, damping, servo_nm = map(np.concatenate, parts)
        # the model has the nominal servo's back-EMF as damping
        emf = traces[0].servo.back_emf_nm_s_rad - plant.servo.back_emf_nm_s_rad
        nominal = inverse_dynamics(plant, plant.model, q, v, a) + emf * v
        weight = 1 / np.maximum(np.median(kp, axis=0), 1e-6)
        return cls(
            JointMotion(t, q, v, a, command, rate, kp, nominal),
            np.median(damping, axis=0),
            weight,
            ((servo_nm - nominal) * weight).reshape(-1),
        )

    def weighted(self, values: FloatArray) -> FloatArray:
        """(R j,) torques (R, j) [N m] of R rows times the joints' weights."""
        return np.asarray((values * self.weight_rad_nm).reshape(-1))


def _rows(trace: Trace, every: int) -> list[FloatArray]:
    """Time, motion, commands, gains and torque (rows, j), at some rows of a trace."""
    q, v, a = smooth_columns(trace.time_s, trace.position_rad)
    command = trace.position_rad if trace.command_rad is None else trace.command_rad
    # around a row the one before it holds as long as its own
    command = (command + np.vstack([command[:1], command[:-1]])) / 2
    rate = np.gradient(command, trace.time_s, axis=0)
    servo, since_s = trace.servo, trace.time_s - trace.time_s[0]
    whole = np.isfinite(np.hstack([q, v, a, command, rate])).all(axis=1)
    inside = (since_s > _EDGE_S) & (since_s < since_s[-1] - _EDGE_S)
    rows = np.flatnonzero(whole & inside)[::every]
    damping = servo.kd_nm_s_rad + servo.back_emf_nm_s_rad
    torque = servo.torque(command - q, v)
    motion = since_s[:, None], q, v, a, command, rate
    columns = *motion, servo.kp_nm_rad, damping, torque
    return [np.broadcast_to(column, q.shape)[rows] for column in columns]


@dataclass(frozen=True, eq=False)
class Column:
    """One column of the regression: torque of an effect for a parameter value of 1.

    The name is empty for a constant torque, which is no effect alone; the parameter is
    given by its index, the torque (N,) is weighted. The damping is that of servo and
    back-EMF at the joint.
    """

    effect: str
    place: str
    parameter: int
    values: FloatArray
    damping_nm_s_rad: float = 1.0

    def named(self, size: float, error: float) -> tuple[str, float, float]:
        """Effect name, parameter value, standard error for a fitted coefficient."""
        if not self.effect:
            return "", size, error
        return effect(self.effect).from_column(size, error, self.damping_nm_s_rad)


def torque_columns(
    plant: Plant, traces: Sequence[Trace], torques: Torques
) -> list[Column]:
    """Regression columns of all effects that are nearly linear in a parameter."""
    columns = [
        column
        for joint in range(len(plant.joints))
        for column in _joint_columns(plant, torques, joint)
    ]
    for kind in all_effects().values():
        if kind.by_inverse_dynamics:
            for place in kind.places(plant, traces):
                columns += _changed_columns(plant, torques, kind, place)
        elif kind.place_kind == "commands" and kind.places(plant, traces):
            columns += _signal_columns(plant, torques, kind)
    return columns


def _joint_columns(plant: Plant, torques: Torques, joint: int) -> Iterator[Column]:
    """Regression columns of effects at one joint, and of a constant torque there."""
    motion, place = _motion_of(torques, joint), plant.joints[joint]
    damping = float(torques.damping_nm_s_rad[joint])

    def column(name: str, parameter: int, values: FloatArray) -> Column:
        """The regression column of an effect whose torque (rows,) acts here only."""
        whole = np.zeros_like(torques.motion.position_rad)
        whole[:, joint] = values
        return Column(name, place, parameter, torques.weighted(whole), damping)

    for kind in all_effects().values():
        values = kind.torque_column(motion) if kind.place_kind == "joint" else None
        if values is not None:
            yield column(kind.name, kind.column_parameter, values)
    yield column("", 0, np.ones_like(motion.position_rad))


def _signal_columns(plant: Plant, torques: Torques, kind: Effect) -> Iterator[Column]:
    """The regression column, if any, of an effect on the commands of all joints."""
    every = [
        kind.torque_column(_motion_of(torques, joint))
        for joint in range(len(plant.joints))
    ]
    values = [one for one in every if one is not None]
    if values:
        whole = np.stack(values, axis=1)
        place, number = kind.place_kind, kind.column_parameter
        yield Column(kind.name, place, number, torques.weighted(whole))


def _motion_of(torques: Torques, joint: int) -> JointMotion:
    """The motion of one joint, taken from arrays of all joints."""
    return JointMotion(*(values[:, joint] for values in vars(torques.motion).values()))


def _changed_columns(
    plant: Plant, torques: Torques, kind: Effect, place: str
) -> Iterator[Column]:
    """Regression columns, by finite differences, of effects on model or pose."""
    motion = torques.motion
    parameters = kind.parameters(plant, place)
    for number, parameter in enumerate(parameters):
        size = parameter.typical or 0.1 * parameter.high
        if kind.place_kind == "joint":
            size = NUDGE_RAD
        values = tuple(size if i == number else 0.0 for i in range(len(parameters)))
        variants = variants_of(plant, [(PlacedEffect(kind.name, place, values),)])
        pose = motion.position_rad - variants.joints.offset_rad[0]
        fields = {name: one[0] for name, one in variants.fields.items()}
        model = model_with(plant, fields)
        moves = pose, motion.velocity_rad_s, motion.acceleration_rad_s2
        change = (inverse_dynamics(plant, model, *moves) - motion.torque_nm) / size
        yield Column(kind.name, place, number, torques.weighted(change))


THRESHOLD = 0.1
"""Smallest part of the missing torque that a column must explain to be kept: the norm
of the column times its coefficient, divided by the norm of the missing torque."""

MOST_EFFECTS = 3
"""Largest number of effects in an answer."""

_ROUNDS = 20
"""Number of rounds of thresholding; results no longer change after a few."""

_RIDGE = 0.05
"""Ridge penalty for columns of norm one, PySINDy's default. It makes coefficients
slightly too small; without it they diverge, since the equation of motion itself is a
sum of columns."""


def answer(
    plant: Plant, traces: Sequence[Trace], reference: Reference | None = None
) -> Verdict:
    """Name the effects that sequential thresholding leaves in a regression, or none.

    Contact forces of a floating base are not known, so there is no answer for one. What
    the same regression explains of the healthy robot's recordings (`reference`) is
    taken as given.

    Source: Brunton, Proctor and Kutz 2016, "Discovering governing equations from data
    by sparse identification of nonlinear dynamical systems".
    """
    begun_s = time.monotonic()
    if plant.base == "floating" or any(t.command_rad is None for t in traces):
        limit = "inverse dynamics need a fixed base and position commands"
        return verdict_of(traces, begun_s, limits=(limit,))
    torques = Torques.of(plant, traces)
    columns = torque_columns(plant, traces, torques)
    table = np.stack([column.values for column in columns], axis=1)
    given = (
        torques.missing if reference is None else _changed(reference, torques, table)
    )
    kept, size, error = sequential_threshold(table, given)
    ranked = _placed(plant, columns, kept, size, error)
    total = sum(part for _, _, part in ranked)
    effects = tuple(
        found_effect(plant, placed, spans, part / total)
        for placed, spans, part in ranked[:MOST_EFFECTS]
    )
    return verdict_of(traces, begun_s, effects)


def _changed(reference: Reference, torques: Torques, table: FloatArray) -> FloatArray:
    """(N,) missing torque less what a regression on the healthy robot explains.

    `table` (N, k) has the columns of the recordings that are to be explained.
    """
    plant, traces = reference.plant, reference.traces
    before = Torques.of(plant, traces)
    columns = torque_columns(plant, traces, before)
    healthy = np.stack([column.values for column in columns], axis=1)
    kept, size, _ = sequential_threshold(healthy, before.missing)
    return np.asarray(torques.missing - table[:, kept] @ size)


def sequential_threshold(
    columns: FloatArray, target: FloatArray, threshold: float = THRESHOLD
) -> tuple[IntArray, FloatArray, FloatArray]:
    """Repeat least squares, each time without the columns that contribute little.

    Of (N, k) columns that explain a target (N,) those are dropped whose norm times
    coefficient is below a share of the target's norm.

    Returns:
      Indices of the columns that remain, their coefficients, and the coefficients'
      standard errors for white residual noise.
    """
    length = np.linalg.norm(columns, axis=0)
    whole = float(np.linalg.norm(target))
    kept = np.flatnonzero(length > 1e-9 * max(float(length.max(initial=0.0)), 1e-300))
    unit = columns[:, kept] / length[kept]
    gram, toward = unit.T @ unit, unit.T @ target
    active, size = np.arange(len(kept)), np.zeros(0)
    for _ in range(_ROUNDS):
        size = np.linalg.solve(_square(gram, active), toward[active])
        large = np.abs(size) >= threshold * whole
        active, size = active[large], size[large]
    fitted = gram[np.ix_(active, active)] @ size
    left = max(whole**2 - float(size @ (2 * toward[active] - fitted)), 0.0)
    variance = left / max(len(target) - len(active), 1)
    spread = np.sqrt(variance * np.diag(np.linalg.inv(_square(gram, active))))
    scale = length[kept[active]]
    return kept[active], size / scale, spread / scale


def _square(gram: FloatArray, active: IntArray) -> FloatArray:
    return gram[np.ix_(active, active)] + _RIDGE * np.eye(len(active))


def _placed(
    plant: Plant,
    columns: Sequence[Column],
    kept: IntArray,
    size: FloatArray,
    error: FloatArray,
) -> list[tuple[PlacedEffect, list[tuple[float, float]], float]]:
    """Effects with values, 80 % intervals and norms of their torques, largest first.

    Coefficients out of a parameter's bounds belong to no effect.
    """
    groups: dict[tuple[str, str], dict[int, tuple[float, float, float]]] = {}
    for index, value, spread in zip(kept, size, error, strict=True):
        column = columns[index]
        name, amount, width = column.named(float(value), float(spread))
        part = abs(float(value)) * float(np.linalg.norm(column.values))
        key = (name, column.place)
        groups.setdefault(key, {})[column.parameter] = (amount, width, part)
    ranked = []
    for (name, place), found in groups.items():
        parameters = effect(name).parameters(plant, place) if name else ()
        values, spans = [], []
        for number, parameter in enumerate(parameters):
            start = parameter.neutral if np.isfinite(parameter.neutral) else 0.0
            amount, width, _ = found.get(number, (start, 0.0, 0.0))
            values.append(amount)
            spans.append((amount - NORMAL_80 * width, amount + NORMAL_80 * width))
        if name and parameters[0].low <= values[0] <= parameters[0].high:
            part = float(np.hypot.reduce([one[2] for one in found.values()]))
            ranked.append((PlacedEffect(name, place, tuple(values)), spans, part))
    return sorted(ranked, key=lambda one: -one[2])
