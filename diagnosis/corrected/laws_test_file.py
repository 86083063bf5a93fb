"""Writes what `test_corrected_laws.py` needs: commands, and what replays make of them.

The test itself is the module `diagnosis.corrected.laws.repeats_replay`, as it is.
"""

import inspect
import io
from typing import Any

import numpy as np

from diagnosis.corrected.laws import repeats_replay
from diagnosis.corrected.laws_file import covered_parts
from diagnosis.corrected.mjcf import friction_solver, native_parts, own_step_s
from diagnosis.plant.plant import Plant
from diagnosis.replay.drive import Held
from diagnosis.replay.replay import replay
from diagnosis.residuals.predictor import Model
from diagnosis.residuals.replays import variants_of
from diagnosis.traces.trace import Trace, filled
from diagnosis.traces.windows import Run, runs_of
from groundwalk.arrays import FloatArray

TEST_LAWS, TEST_LAWS_NPZ = "test_corrected_laws.py", "corrected_laws_test.npz"

LONGEST_S = 2.0
"""Time [s] that is compared: long enough for motion in both directions, short enough to
keep the file small."""

TOLERANCE_RAD = 1e-4
"""Largest difference [rad]: both take the same steps of the same laws, so that only
rounding remains; this is a third of the noise of good encoders."""

BETWEEN_STEPS = 4 / 27
"""By how much two cubics through the same positions differ, in steps times the change
of speed in a step. MuJoCo's has central differences as slopes, which are wrong by half
of that change at most, and each of two slopes counts by 4/27 of a step at most (the
largest value of the Hermite polynomial t (1 - t)^2). Only where encoders are late by
other than whole steps."""

CLEAR = 2
"""By how many tolerances laws must change the motion to be sure to show in the test."""


def text_of_test() -> str:
    """The text of `test_corrected_laws.py`."""
    return inspect.getsource(repeats_replay)


def expected_npz(plant: Plant, model: Model, trace: Trace) -> bytes:
    """The content of `corrected_laws_test.npz` for a recording with position commands.

    `model` are the effects as given to `corrected_mjcf`; those that no file has are
    left out. The seconds that are compared begin with the recording.
    """
    step_s = own_step_s(plant)
    run = _by_steps(runs_of(plant, trace)[0], step_s)
    here = covered_parts(model)
    variants = variants_of(plant, [here, native_parts(here)])
    replayed = replay([run], variants, step_s)[0]
    both = replayed.position_rad
    each_s = np.maximum(variants.late_s[0], 0.0)
    first = int(np.ceil(each_s.max() / step_s)) + 1
    first = min(first, run.trace.ticks - 1)
    tolerance = TOLERANCE_RAD
    if (each_s % step_s).any():
        change = np.abs(np.diff(replayed.velocity_rad_s[0], axis=0)).max(initial=0.0)
        tolerance += BETWEEN_STEPS * step_s * float(change)
    lacking = np.abs(both[0] - both[1])[first:]
    solver = friction_solver(plant, here, trace.servo, step_s)
    stored: dict[str, Any] = {
        **_start(plant, run, each_s),
        "joints": np.array(plant.joints),
        "position_rad": both[0],
        "first_row": first,
        "tolerance_rad": tolerance,
        "laws_show": bool((lacking > CLEAR * tolerance).any()),
        "integrator": plant.model.opt.integrator,
        "disableflags": plant.model.opt.disableflags,
        "dof_solref": solver[0],
        "dof_solimp": solver[1],
    }
    content = io.BytesIO()
    np.savez_compressed(content, **stored)
    return content.getvalue()


def _by_steps(run: Run, step_s: float) -> Run:
    """The start of a run, with a row and a command for each physics step.

    Commands are interpolated: one that jumps within a step, as it may if it is late, is
    a matter of how finely sims resolve a step.
    """
    trace, whole = run.trace, run.whole or run.trace
    assert whole.command_rad is not None
    steps = max(int(min(trace.duration_s, LONGEST_S) / step_s), 1)
    time_s = trace.time_s[0] + np.arange(steps + 1) * step_s
    asked = filled(whole.command_rad).T
    command_rad = np.stack([np.interp(time_s, whole.time_s, a) for a in asked], axis=1)
    added_nm = np.zeros_like(command_rad)
    if whole.added_nm is not None:
        added_nm = Held(whole.time_s, whole.added_nm).mean(time_s, step_s)
    position_rad = np.tile(run.position_rad, (steps + 1, 1))
    by_steps = Trace(
        trace.name,
        time_s,
        position_rad,
        trace.servo,
        command_rad=command_rad,
        added_nm=added_nm,
    )
    return Run(by_steps, run.position_rad, run.velocity_rad_s, run.base)


def _start(plant: Plant, run: Run, late_s: FloatArray) -> dict[str, FloatArray]:
    """State of corrected.xml at the start, and what drives it in each step.

    Joints are read late by (j,) times: by now they have moved on.
    """
    model = plant.model
    qpos, qvel = model.qpos0.copy(), np.zeros(model.nv)
    if run.base is not None:
        qpos[:7], qvel[:6] = run.base[:7], run.base[7:]
    # late encoders show where the joints were; by now they have moved on
    qpos[plant.qpos] = run.position_rad + late_s * run.velocity_rad_s
    qvel[plant.dofs] = run.velocity_rad_s
    assert run.trace.command_rad is not None
    assert run.trace.added_nm is not None
    return {
        "start_s": np.array(run.trace.time_s[0]),
        "qpos": qpos,
        "qvel": qvel,
        "targets_rad": run.trace.command_rad[:-1],
        "torques_nm": run.trace.added_nm[:-1],
    }
