"""Writes `corrected_laws.py`: what `corrected.xml` lacks, as one file to be read.

The file consists of values and of the classes in `diagnosis.corrected.laws`, so that it
needs NumPy and MuJoCo only.
"""

import inspect
import json
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from diagnosis.corrected.laws.commands import LateCommand, LimitedSetPoint
from diagnosis.corrected.laws.controller import Controller
from diagnosis.corrected.laws.driver import CorrectedLaws
from diagnosis.corrected.laws.dry_friction import DryFriction
from diagnosis.corrected.laws.elastic import ElasticDrive
from diagnosis.corrected.laws.gyroscope import GyroscopeBias
from diagnosis.corrected.laws.outside import Drag, Push
from diagnosis.corrected.laws.play import Play
from diagnosis.corrected.laws.presliding import Presliding
from diagnosis.corrected.laws.ripple import Ripple
from diagnosis.corrected.laws.saturation import Saturation
from diagnosis.corrected.laws.step import Joint, Law, Step
from diagnosis.corrected.laws.supply import SupplySag
from diagnosis.corrected.laws.weak_servo import WeakServo
from diagnosis.effects.library import effect
from diagnosis.effects.parts import PlacedEffect
from diagnosis.effects.ripple import Cogging
from diagnosis.effects.variants import Variants
from diagnosis.plant.plant import Plant
from diagnosis.plant.servo import Servo
from diagnosis.replay.controllers import CONTROLLED, derivative_lag_s
from diagnosis.replay.dry_friction import VARYING
from diagnosis.replay.servos import servo_laws
from diagnosis.replay.set_points import LIMITS
from diagnosis.residuals.predictor import Model
from diagnosis.residuals.replays import variants_of
from groundwalk.arrays import FloatArray

CORRECTED_LAWS = "corrected_laws.py"

Values = list[dict[str, Any]]
"""The arguments of several laws of one kind, by name."""

NAMES: Mapping[type[Law], str] = {
    LateCommand: "LATE_COMMANDS",
    LimitedSetPoint: "LIMITED_SET_POINTS",
    SupplySag: "SUPPLY_SAG",
    WeakServo: "WEAK_SERVOS",
    DryFriction: "DRY_FRICTION",
    Ripple: "RIPPLES",
    Controller: "CONTROLLERS",
    Play: "PLAY",
    Presliding: "PRESLIDING",
    ElasticDrive: "ELASTIC_DRIVES",
    Saturation: "SATURATION",
    Push: "PUSHES",
    Drag: "DRAG",
    GyroscopeBias: "GYROSCOPE_BIAS",
}
"""Names of the constants with the values of each kind of law, in the order in which
laws act in a step."""

FRICTION: Mapping[str, str] = {
    "stribeck_nm": "extra_nm",
    "stribeck_speed_rad_s": "speed_rad_s",
    "stribeck_exponent": "exponent",
    "angle_nm": "angle_nm",
    "angle_log_1_rad": "angle_log_1_rad",
    **{
        name: name
        for name in (
            *("load_share", "link_share", "extra_load_share", "extra_link_share"),
            "extra_square_1_nm",
        )
    },
}
"""Arguments of the law of dry friction, by the attributes of `Joints` they are."""

ON_COMMANDS = (LimitedSetPoint, Controller, Play, ElasticDrive, Saturation)
"""Laws that need a command when it is due, so that its delay must come before them."""

_IMPORTS = """from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt
"""

_LOAD = '''
def load() -> tuple[mujoco.MjModel, mujoco.MjData, CorrectedLaws]:
    """Load the model corrected.xml beside this file, its state, and its laws."""
    model = mujoco.MjModel.from_xml_path(str(Path(__file__).parent / "corrected.xml"))
    data = mujoco.MjData(model)
    return model, data, CorrectedLaws(model, data, BACK_EMF_NM_S_RAD, LAWS)
'''


def covered_parts(model: Model) -> Model:
    """The effects that `corrected.xml` or `corrected_laws.py` has; all but a few."""
    return tuple(placed for placed in model if not _why_left_out(placed))


def laws_text(plant: Plant, model: Model, servo: Servo | None = None) -> str:
    """The text of `corrected_laws.py`; "" if `corrected.xml` holds all effects.

    `model` and `servo` are those of `corrected_mjcf`.
    """
    if all(effect(placed.name).native for placed in model):
        return ""
    variants, servo = variants_of(plant, [covered_parts(model)]), servo or plant.servo
    found = _values(variants, servo)
    back_emf = servo_laws([servo], vars(variants.joints))["emf"][0]
    emf = dict(zip(plant.joints, map(float, back_emf), strict=True))
    values = [f"BACK_EMF_NM_S_RAD = {_shown(emf)}"]
    values += [f"{NAMES[kind]} = {_shown_rows(rows)}" for kind, rows in found.items()]
    table = "".join(f"    ({kind.__name__}, {NAMES[kind]}),\n" for kind in found)
    laws = f"\nLAWS = (\n{table})\n"
    every = (Joint, Step, Law, *found, CorrectedLaws)
    source = "\n\n".join(inspect.getsource(kind) for kind in every)
    source = source.replace("Parts,", "Sequence[tuple[type[Law], Sequence[Any]]],")
    head = f'"""{_docstring(plant, model)}"""\n\n{_IMPORTS}'
    return "\n".join([head, *values, "", "", source, laws, _LOAD])


def _why_left_out(placed: PlacedEffect) -> str:
    """Why no file has an effect; "" if one has."""
    kind = effect(placed.name)
    if kind.native:
        return ""
    if placed.recording is not None:
        return f"it happened in {placed.recording} only"
    return kind.no_law


def _docstring(plant: Plant, model: Model) -> str:
    lacking = [placed for placed in model if not effect(placed.name).native]
    out = [one for one in lacking if _why_left_out(one)]
    here = [one.key for one in lacking if not _why_left_out(one)]
    lines = [
        f"Physics of {plant.name} that corrected.xml lacks, for each physics step.",
        "",
        "`groundwalk diagnose` found it and wrote this file, which needs NumPy and",
        "MuJoCo only. Units are rad and N m, at joints that slide m and N.",
        "",
        *(["In this file:", *(f"- {key}" for key in here), ""] if here else []),
        *(["Left out:", *map(_told, out), ""] if out else []),
        "Example:",
        "  >>> model, data, laws = load()",
        "  >>> for _ in range(1000):",
        f'  ...     laws.before_step({{"{plant.joints[0]}": 0.3}})',
        "  ...     mujoco.mj_step(model, data)",
        "  >>> angle, speed = laws.readings()"
        f'["{plant.joints[0]}"]  # as the encoder shows them',
    ]
    told = "\n".join(lines) + "\n"
    return told.replace("\\", "/").replace('"' * 3, '"')  # names may hold anything


def _told(placed: PlacedEffect) -> str:
    return f"- {placed.key}:\n  {_why_left_out(placed)}"


def _values(variants: Variants, servo: Servo) -> dict[type[Law], Values]:
    """Values of all laws of the only variant, by kind, in the order they act."""
    each = list(_each(variants, servo))
    found = {kind: [v for k, v in each if k is kind] for kind in NAMES}
    return {kind: values for kind, values in found.items() if values}


def _each(
    variants: Variants, servo: Servo
) -> Iterator[tuple[type[Law], dict[str, Any]]]:
    """Every law of the only variant, and its values."""
    plant, signals = variants.plant, variants.signals
    armature = variants.fields.get("dof_armature", plant.model.dof_armature[None])
    law = servo_laws([servo], vars(variants.joints))
    saturates = np.isfinite(law["limit"][0]) & (law["kd"][0] > 0)
    acts_on_commands = False
    for column, name in enumerate(plant.joints):
        own = {key: float(v[0, column]) for key, v in vars(variants.joints).items()}
        rotor = float(armature[0, plant.dofs[column]])
        late_s = float(variants.late_s[0, column])
        laws = list(_of_joint(own, rotor, max(late_s, 0.0)))
        gains = float(law["kp"][0, column]), float(law["kd"][0, column])
        laws += _controllers(own, lag_s=derivative_lag_s(*map(np.array, gains)))
        if saturates[column] and np.isinf(own["spring_nm_rad"]):
            laws.append((Saturation, {}))
        for kind, values in laws:
            acts_on_commands |= kind in ON_COMMANDS
            yield kind, {"joint": name, **values}
    delay_s = float(signals.command_delay_s[0])
    if acts_on_commands and delay_s > 0:  # no longer the actuators' affair
        for name in plant.joints:
            yield LateCommand, {"joint": name, "delay_s": delay_s}
    taken = variants.joints.sag_1_nm[0]
    if taken.any():
        lost = dict(zip(plant.joints, map(float, taken), strict=True))
        yield SupplySag, {"lost_1_nm": lost}
    yield from _ripples(variants)
    bias = [float(one) for one in signals.gyro_bias_rad_s[0]]
    if any(bias):
        yield GyroscopeBias, dict(zip("xyz", bias, strict=True))
    for push in variants.outside.pushes[0]:
        yield Push, vars(push)
    for body in np.flatnonzero(variants.outside.drag_n_s_m[0]):
        drag = float(variants.outside.drag_n_s_m[0, body])
        yield Drag, {"body": plant.model.body(body).name, "coefficient_n_s_m": drag}


def _ripples(variants: Variants) -> Iterator[tuple[type[Law], dict[str, Any]]]:
    """Ripples of the only variant, at the joints that have any."""
    names = ("torque_nm", "per_turn", "phase_rad")
    offset = variants.joints.offset_rad[0]
    for kind, torques in variants.torques.items():
        if not isinstance(kind, Cogging):
            continue
        for column in np.flatnonzero(torques[0, :, 0]).tolist():
            own = dict(zip(names, map(float, torques[0, column]), strict=True))
            own["offset_rad"] = float(offset[column])
            yield Ripple, {"joint": variants.plant.joints[column], **own}


def _controllers(
    own: Mapping[str, float], lag_s: FloatArray
) -> Iterator[tuple[type[Law], dict[str, float]]]:
    """What the servo at one joint does with its error, if anything is new."""
    if any(own[name] for name in CONTROLLED):
        values = {name: own[name] for name in CONTROLLED}
        yield Controller, {**values, "lag_s": float(lag_s)}


def _of_joint(
    own: Mapping[str, float], rotor_kg_m2: float, encoder_late_s: float
) -> Iterator[tuple[type[Law], dict[str, float]]]:
    """Laws at one joint, whose values are those of `Joints` by name."""
    limits = {name.removeprefix("setpoint_"): own[name] for name in LIMITS}
    finite = {name: value for name, value in limits.items() if np.isfinite(value)}
    if finite:
        yield LimitedSetPoint, finite
    if own["fade_1_s"] or own["off_share"]:
        names = ("fade_1_s", "off_share", "off_start_s", "off_end_s")
        yield WeakServo, {name: own[name] for name in names}
    if any(own[name] for name in VARYING):
        values = {new: own[name] for name, new in FRICTION.items()}
        # corrected.xml's angles are those that encoders show
        values["angle_from_rad"] = own["angle_from_rad"] + own["offset_rad"]
        yield DryFriction, values
    if own["slip_nm"]:
        values = {"torque_nm": own["slip_nm"], "reach_rad": own["slip_rad"]}
        yield Presliding, values
    if own["gap_rad"]:
        yield Play, {"gap_rad": own["gap_rad"]}
    if np.isfinite(own["spring_nm_rad"]):
        yield (
            ElasticDrive,
            {
                "stiffness_nm_rad": own["spring_nm_rad"],
                "damping_nm_s_rad": own["spring_damping_nm_s_rad"],
                "rotor_kg_m2": rotor_kg_m2,
                "delay_s": encoder_late_s,
            },
        )


def _shown(values: Mapping[str, Any]) -> str:
    """A dictionary as code, an entry a line."""
    lines = (f"    {json.dumps(key)}: {value!r},\n" for key, value in values.items())
    return "{\n" + "".join(lines) + "}"


def _shown_rows(rows: Values) -> str:
    """A list of dictionaries as code, a dictionary a line."""
    return "[\n" + "".join(f"    {json.dumps(row)},\n" for row in rows) + "]"
