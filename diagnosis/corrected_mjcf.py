"""A plant with the effects in it that MuJoCo has, as MJCF: `corrected.xml`."""

import ctypes
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from diagnosis.batch_friction import BatchFriction
from diagnosis.batch_servos import BatchServos
from diagnosis.effect import Placed
from diagnosis.library import effect
from diagnosis.plant import Plant
from diagnosis.predictor import Model, variants_of
from diagnosis.replay import STEP_S
from diagnosis.servo import Servo
from diagnosis.variants import Variants
from groundwalk.arrays import FloatArray

if TYPE_CHECKING:
    import mujoco

CORRECTED_XML = "corrected.xml"
_DIGITS = 17
"""As many as it takes to read a number back as it was."""


def corrected_mjcf(
    plant: Plant,
    model: Model,
    servo: Servo | None = None,
    step_s: float = STEP_S,
) -> str:
    """MJCF of a plant with the native effects of a model; the others are left out.

    Controls are position targets of the plant's joints. A late command is an
    actuator's `delay`; before the first one is due the target is 0.

    Args:
      plant: nominal.
      model: the effects.
      servo: of the recordings; the plant's own where None.
      step_s: of the physics, for which contacts and friction are set.
    """
    native = tuple(placed for placed in model if effect(placed.effect).native)
    variants = variants_of(plant, [native])
    spec = plant.spec.copy()
    spec.option.timestep = step_s
    compiled = spec.compile()
    _write_fields(compiled, variants, servo or plant.servo, step_s)
    spec.copy_back(compiled)
    _delay_commands(spec, float(variants.signals.command_delay_s[0]), step_s)
    folder = Path(spec.modelfiledir or ".").resolve()
    spec.meshdir = str(folder / spec.meshdir) if spec.meshes else spec.meshdir
    with _all_digits():
        return spec.to_xml()
