"""Writes `corrected_joints.csv`: what simulators ask for at each joint, as a table.

A joint's armature, damping, friction, gains, torque limit and delay are settings of
other simulators, too. Where an effect that was found changes one, its interval is that
of the effect's estimate.
"""

import csv
import io
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from diagnosis.effects.library import effect
from diagnosis.effects.parts import PlacedEffect
from diagnosis.effects.variants import Variants
from diagnosis.plant.plant import Plant
from diagnosis.plant.servo import Servo
from diagnosis.replay.servos import servo_laws
from diagnosis.residuals.predictor import Model
from diagnosis.residuals.replays import variants_of
from diagnosis.verdict import Found
from groundwalk.arrays import BoolArray, FloatArray

CORRECTED_JOINTS = "corrected_joints.csv"

COLUMNS = {
    "armature": "kg m^2",
    "damping": "N m s/rad",
    "friction": "N m",
    "friction at rest": "N m",
    "kp": "N m/rad",
    "kd": "N m s/rad",
    "torque limit": "N m",
    "delay": "s",
}
"""Units of the quantities of a joint that turns; at one that slides kg, N and m."""


def joints_csv(
    plant: Plant, model: Model, found: Sequence[Found], servo: Servo | None = None
) -> str:
    """The table as CSV: a row a joint, and three columns a quantity.

    These are the value in the corrected sim and its 80 % interval, which is empty where
    no effect changes the value of the nominal model. `damping` includes the motor's
    back-EMF, `friction` is dry friction in motion, `kp` and `kd` are the servo's gains,
    and `delay` is that of commands. What depends on load, play and springs in gears
    have no column. No value is below 0, as other simulators demand: small mismatch of a
    link's inertia may have made its armature negative.

    Args:
      plant: the nominal robot model.
      model: the effects with their values, as given to `corrected_mjcf`.
      found: the effects of the verdict, with intervals of their values.
      servo: gains of the recordings if not the plant's own.
    """
    servo = servo or plant.servo
    changed = [other for one in found for other in _at_ends(plant, model, one)]
    values = _values(variants_of(plant, [model, *changed]), servo)
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    header = [
        f"{name}{end} [{unit}]"
        for name, unit in COLUMNS.items()
        for end in ("", " low", " high")
    ]
    table.writerow(["joint", "slides", *header])
    columns = [_with_interval(values[name]) for name in COLUMNS]
    for row, joint in enumerate(plant.joints):
        cells = [cell for column in columns for cell in column[row]]
        table.writerow([joint, "yes" if joint in plant.slides else "no", *cells])
    return text.getvalue()


def _at_ends(plant: Plant, model: Model, found: Found) -> list[Model]:
    """The model with each value of one effect at both ends of its interval.

    Low and high end follow each other. Of equal effects at one place the last one is
    meant: those that the healthy robot had come first.
    """
    keys = [(placed.name, placed.place) for placed in model]
    if (found.name, found.place) not in keys:
        return []
    at = len(keys) - 1 - keys[::-1].index((found.name, found.place))
    names = [one.name for one in effect(found.name).parameters(plant, found.place)]
    estimates = [found.parameters[name] for name in names]
    return [
        (*model[:at], _with(model[at], index, end), *model[at + 1 :])
        for index, estimate in enumerate(estimates)
        for end in (estimate.low, estimate.high)
    ]


def _with(placed: PlacedEffect, index: int, value: float) -> PlacedEffect:
    values = (*placed.values[:index], value, *placed.values[index + 1 :])
    return replace(placed, values=values)


def _values(variants: Variants, servo: Servo) -> dict[str, FloatArray]:
    """(n, j) quantities by the names of their columns, of n variants of the model."""
    plant, joints = variants.plant, variants.joints
    law = servo_laws([servo], vars(joints))
    emf = law["emf"] - plant.servo.back_emf_nm_s_rad
    friction = _of_dofs(variants, "dof_frictionloss") + joints.coulomb_nm
    delay_s = variants.signals.command_delay_s[:, None]
    found = {
        "armature": _of_dofs(variants, "dof_armature"),
        "damping": _of_dofs(variants, "dof_damping") + emf,
        "friction": friction,
        "friction at rest": friction + joints.stribeck_nm,
        "kp": law["kp"],
        "kd": law["kd"],
        "torque limit": law["limit"],
        "delay": np.broadcast_to(delay_s, law["kp"].shape),
    }
    return {name: np.maximum(values, 0.0) for name, values in found.items()}


def _of_dofs(variants: Variants, name: str) -> FloatArray:
    """(n, j) values of a field of `MjModel` at the joints of all variants."""
    plant = variants.plant
    nominal = np.tile(getattr(plant.model, name), (variants.n, 1))
    return np.asarray(variants.fields.get(name, nominal)[:, plant.dofs])


def _with_interval(values: FloatArray) -> list[list[str]]:
    """For each joint the value, low and high as text, from those of (n, j) variants.

    The first variant has the value; then come pairs with one parameter at its low and
    its high end. Errors of several parameters are independent: squares are added.
    """
    value = values[0]
    known = np.isfinite(value)
    ends = np.where(known, values[1:] - np.where(known, value, 0.0), 0.0)
    pairs = ends.reshape(-1, 2, values.shape[1])
    down = np.sqrt((np.minimum(pairs.min(axis=1, initial=0.0), 0) ** 2).sum(axis=0))
    up = np.sqrt((np.maximum(pairs.max(axis=1, initial=0.0), 0) ** 2).sum(axis=0))
    estimated: BoolArray = (down > 0) | (up > 0)
    return [
        [_number(v), *((_number(v - d), _number(v + u)) if sure else ("", ""))]
        for v, d, u, sure in zip(value, down, up, estimated, strict=True)
    ]


def _number(value: float) -> str:
    return f"{value:.6g}"
