"""Writes `corrected.xml`: a robot's MJCF with the effects that MuJoCo can simulate."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace

import mujoco
import numpy as np

from diagnosis.effects.library import effect
from diagnosis.effects.variants import Variants
from diagnosis.plant.plant import Plant
from diagnosis.plant.servo import Servo
from diagnosis.replay.joint_friction import BatchFriction
from diagnosis.replay.replay import STEP_S
from diagnosis.replay.servos import BatchServos
from diagnosis.residuals.predictor import Model
from diagnosis.residuals.replays import variants_of
from groundwalk.arrays import BoolArray, FloatArray
from robots.engine_models.mjcf import mujoco_library

CORRECTED_XML = "corrected.xml"
_LINEAR, _CUBIC = 1, 2
"""MuJoCo's codes for interpolation between delayed controls, and between readings."""
_AROUND = 3
"""Samples beyond the delay that cubic interpolation needs: a spline has four."""

_CONTACTS = " and all contacts switched off"
_DIGITS = 17
"""Number of decimal digits with which every 64-bit float is read back unchanged."""


def corrected_mjcf(
    plant: Plant, model: Model, servo: Servo | None = None, step_s: float | None = None
) -> str:
    """MJCF of a robot model with those effects in it that MuJoCo can simulate.

    Time step, integrator, contact flags and solver parameters are those of the model's
    own file, except at joints with new friction. An XML comment lists the differences.
    Controls are position targets of the joints. Late commands become the actuators'
    `delay`; until the first command is due the target is 0. An encoder's offset is the
    joint's `ref`, so that `qpos` is the measured angle. Late encoders are sensors
    `position.<joint>` and `velocity.<joint>` with a `delay`. A constant torque is part
    of the actuator's force, beside its torque limit.

    Effects of the `model` that MuJoCo cannot simulate are left out, see
    `laws_file.laws_text`. `servo` are the gains of the recordings if not the plant's
    own; the time step is `own_step_s` by default.
    """
    native = native_parts(model)
    variants = variants_of(plant, [native])
    spec = plant.spec.copy()
    options = plant.options
    if options is not None:
        spec.option.integrator = options.integrator
        spec.option.disableflags = options.disableflags
    spec.option.timestep = step_s = step_s or own_step_s(plant)
    compiled = spec.compile()
    own = compiled.dof_solimp.copy(), compiled.dof_solref.copy()
    _write_fields(compiled, variants, servo or plant.servo, step_s)
    rubs = _rubs(variants_of(plant, [model]))
    same = np.ones(compiled.nv, bool)
    same[np.array(plant.dofs)[rubs]] = False
    compiled.dof_solimp[same], compiled.dof_solref[same] = own[0][same], own[1][same]
    spec.copy_back(compiled)
    signals = variants.signals
    _delay_commands(spec, float(signals.command_delay_s[0]), step_s)
    _delay_readings(spec, plant.joints, variants.late_s[0], step_s)
    folder = Path(spec.modelfiledir or ".").resolve()
    spec.meshdir = str(folder / spec.meshdir) if spec.meshes else spec.meshdir
    with _all_digits():
        head, line, rest = str(spec.to_xml()).partition("\n")
    return f"{head}{line}{_comment(variants, native, model)}{rest}"


def own_step_s(plant: Plant) -> float:
    """Time step [s] of the model's own file; 2 ms if it has none."""
    return plant.options.timestep_s if plant.options else STEP_S


def native_parts(model: Model) -> Model:
    """What MuJoCo can simulate of the effects of a model: all, a part, or nothing."""
    parts = (effect(placed.name).native_part(placed) for placed in model)
    return tuple(part for part in parts if part is not None)


def friction_solver(
    plant: Plant, model: Model, servo: Servo, step_s: float
) -> tuple[FloatArray, FloatArray]:
    """MuJoCo's `dof_solref` (nv, 2) and `dof_solimp` (nv, 5) in the diagnosis' replays.

    They make friction stop a joint within a step at all joints, also those whose own
    softer parameters `corrected_mjcf` leaves as they are. `model` are all effects: the
    rotor of an elastic joint is no part of its link.
    """
    variants = variants_of(plant, [model])
    soft = np.isfinite(variants.joints.spring_nm_rad[0])
    variants.field("dof_armature")[0, np.array(plant.dofs)[soft]] = 0.0
    compiled = plant.spec.compile()
    _write_fields(compiled, variants, servo, step_s)
    return compiled.dof_solref.copy(), compiled.dof_solimp.copy()


def _rubs(variants: Variants) -> BoolArray:
    """(j,) whether a joint has any dry friction that effects of a variant add."""
    joints = variants.joints
    return np.asarray(
        (joints.coulomb_nm[0] + joints.stribeck_nm[0] + joints.load_share[0]) != 0
    )


def _comment(variants: Variants, native: Model, model: Model) -> str:
    """XML comment on how the corrected MJCF differs from the nominal robot model."""
    plant = variants.plant
    others = [placed.key for placed in model if placed not in native]
    late = bool((variants.late_s[0] > 0).any())
    rub = [plant.joints[i] for i in np.flatnonzero(_rubs(variants_of(plant, [model])))]
    lines = [
        f"{plant.name} with the effects that groundwalk diagnose found.",
        f"In this file: {', '.join(placed.key for placed in native) or 'none'}.",
        f"Not in this file, MuJoCo lacks them: {', '.join(others)}. What a step needs "
        "of them is in corrected_laws.py beside this file."
        if others
        else "",
        "Angles (qpos) are those that encoders show, offsets included."
        if variants.joints.offset_rad.any()
        else "",
        "The sensors position.<joint> and velocity.<joint> are as late as the encoders."
        if late
        else "",
        f"Friction solver parameters (solreffriction, solimpfriction) are stiff at "
        f"{', '.join(rub)}: with softer ones the friction found creeps."
        if rub and not plant.creeps
        else "",
        "Actuators are position servos with the recordings' gains, named as their "
        "joints. Joints that no recording has are held at zero, and bodies that do "
        "not move are merged with what carries them.",
        f"The diagnosis itself ran with a time step of {STEP_S:g} s, the integrator "
        f"implicitfast{_CONTACTS if plant.base == 'fixed' else ''}.",
    ]
    told = "\n".join(f"    {line}" for line in lines if line).replace("--", "- -")
    return f"  <!--\n{told}\n  -->\n"


def _write_fields(
    compiled: mujoco.MjModel, variants: Variants, servo: Servo, step_s: float
) -> None:
    """Write servo gains and the only variant's effects into a compiled model."""
    for name, values in variants.fields.items():
        *holder, last = name.split(".")
        target = compiled.opt if holder else compiled
        value = getattr(target, last)
        if isinstance(value, np.ndarray):
            value[...] = values[0]
        else:
            setattr(target, last, type(value)(values[0]))
    _shift_zeros(compiled, variants)
    data = mujoco.MjData(compiled)
    mujoco.mj_setConst(compiled, data)
    # code for a batch writes to the fields of one model, as views (1, ...)
    one = SimpleNamespace(
        expand=lambda name: np.asarray(getattr(compiled, name))[None],
        bind=lambda name: np.asarray(getattr(data, name))[None],
    )
    joints = vars(variants.joints)
    servos = BatchServos(one, variants.plant, [servo], joints, step_s)
    damping = servos.damping_nm_s_rad
    rows, limits = variants.plant.actuators, servos.law["limit"][0]
    compiled.actuator_forcelimited[rows] = np.isfinite(limits)
    _add_constant_torques(compiled, variants)
    BatchFriction(one, variants.plant, joints, damping, step_s)


def _shift_zeros(compiled: mujoco.MjModel, variants: Variants) -> None:
    """Make joint angles those that encoders show; the robot stays where it is."""
    plant, offset = variants.plant, variants.joints.offset_rad[0]
    for name, qpos, shift in zip(plant.joints, plant.qpos, offset, strict=True):
        compiled.qpos0[qpos] += shift
        compiled.qpos_spring[qpos] += shift
        joint = compiled.joint(name).id
        if compiled.jnt_limited[joint]:
            compiled.jnt_range[joint] += shift


def _add_constant_torques(compiled: mujoco.MjModel, variants: Variants) -> None:
    """Add torques that never change to the actuators' forces, beside their limits."""
    rows, none = variants.plant.actuators, np.zeros((1, len(variants.plant.joints)))
    for kind, values in variants.torques.items():
        torque_nm = kind.torque_nm(values, none, none, none[:, :1])[0]
        compiled.actuator_biasprm[rows, 0] += torque_nm
        compiled.actuator_forcerange[rows] += torque_nm[:, None]


def _delay_commands(spec: mujoco.MjSpec, delay_s: float, step_s: float) -> None:
    """Delay all actuators' controls, interpolating if the delay is not whole steps.

    MuJoCo delays by a step at least. Less than half of one is left out, and so is a
    negative delay, as that of a clock may be.
    """
    if delay_s < step_s / 2:
        return
    for actuator in spec.actuators:
        actuator.delay = delay_s
        actuator.nsample = int(np.ceil(delay_s / step_s)) + 1
        actuator.interp = _LINEAR


def _delay_readings(
    spec: mujoco.MjSpec, joints: Sequence[str], late_s: FloatArray, step_s: float
) -> None:
    """Add sensors of joints' positions and velocities that are late by (j,) times.

    As of commands, a delay of less than half a step is left out.
    """
    kinds = mujoco.mjtSensor
    for name, delay_s in zip(joints, late_s.tolist(), strict=True):
        if delay_s < step_s / 2:
            continue
        for quantity, kind, interpolation in (
            ("position", kinds.mjSENS_JOINTPOS, _CUBIC),
            ("velocity", kinds.mjSENS_JOINTVEL, _LINEAR),
        ):
            sensor = spec.add_sensor(name=f"{quantity}.{name}", type=kind)
            sensor.objtype, sensor.objname = mujoco.mjtObj.mjOBJ_JOINT, name
            sensor.delay, sensor.interp = delay_s, interpolation
            sensor.nsample = int(np.ceil(delay_s / step_s)) + _AROUND


@contextmanager
def _all_digits() -> Iterator[None]:
    """Let MuJoCo write XML with 17 digits in this block; it writes six by default."""
    library = mujoco_library()
    before = library._mjPRIVATE__get_xml_precision()
    library._mjPRIVATE__set_xml_precision(_DIGITS)
    try:
        yield
    finally:
        library._mjPRIVATE__set_xml_precision(before)
