"""Writes `corrected.xml`: a robot's MJCF with the effects that MuJoCo can simulate."""

import ctypes
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace

import mujoco
import numpy as np

from diagnosis.effects.library import effect
from diagnosis.effects.variants import Variants
from diagnosis.plant.plant import Plant
from diagnosis.plant.servo import Servo
from diagnosis.replay.replay import STEP_S
from diagnosis.replay.servos import BatchFriction, BatchServos
from diagnosis.residuals.predictor import Model
from diagnosis.residuals.replays import variants_of

CORRECTED_XML = "corrected.xml"
_LINEAR = 1
"""MuJoCo's code for linear interpolation between two delayed controls."""

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
    `delay`; until the first command is due the target is 0.

    Effects of the `model` that MuJoCo cannot simulate are left out. `servo` are the
    gains of the recordings if not the plant's own; the time step is the model file's
    own, or 2 ms if it has none.
    """
    native = tuple(placed for placed in model if effect(placed.name).native)
    variants = variants_of(plant, [native])
    spec = plant.spec.copy()
    options = plant.options
    if options is not None:
        spec.option.integrator = options.integrator
        spec.option.disableflags = options.disableflags
    spec.option.timestep = step_s = step_s or (
        options.timestep_s if options else STEP_S
    )
    compiled = spec.compile()
    _write_fields(compiled, variants, servo or plant.servo, step_s)
    spec.copy_back(compiled)
    _delay_commands(spec, float(variants.signals.command_delay_s[0]), step_s)
    folder = Path(spec.modelfiledir or ".").resolve()
    spec.meshdir = str(folder / spec.meshdir) if spec.meshes else spec.meshdir
    with _all_digits():
        head, line, rest = str(spec.to_xml()).partition("\n")
    return f"{head}{line}{_comment(variants, native, model)}{rest}"


def _comment(variants: Variants, native: Model, model: Model) -> str:
    """XML comment on how the corrected MJCF differs from the nominal robot model."""
    plant = variants.plant
    others = [placed.key for placed in model if placed not in native]
    rub = [plant.joints[i] for i in np.flatnonzero(variants.joints.coulomb_nm[0])]
    lines = [
        f"{plant.name} with the effects that groundwalk diagnose found.",
        f"In this file: {', '.join(placed.key for placed in native) or 'none'}.",
        f"Not in this file, MuJoCo lacks them: {', '.join(others)}." if others else "",
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
    own = compiled.dof_solimp.copy(), compiled.dof_solref.copy()
    BatchFriction(one, variants.plant, joints, damping, step_s)
    same = np.ones(compiled.nv, bool)
    same[np.array(variants.plant.dofs)[variants.joints.coulomb_nm[0] != 0]] = False
    compiled.dof_solimp[same], compiled.dof_solref[same] = own[0][same], own[1][same]


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


@contextmanager
def _all_digits() -> Iterator[None]:
    """Let MuJoCo write XML with 17 digits in this block; it writes six by default."""
    folder = Path(mujoco.__file__).parent
    library = ctypes.CDLL(str(next(folder.glob("*mujoco.*"))))
    before = library._mjPRIVATE__get_xml_precision()
    library._mjPRIVATE__set_xml_precision(_DIGITS)
    try:
        yield
    finally:
        library._mjPRIVATE__set_xml_precision(before)
