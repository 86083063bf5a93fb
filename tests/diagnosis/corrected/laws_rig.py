"""Runs `corrected_laws.py` with MuJoCo alone, beside replays of the diagnosis."""

import sys
from dataclasses import replace
from types import ModuleType

import mujoco
import numpy as np
from joint_rigs import run_from, smooth_command, ticks, trace_of

from diagnosis.corrected.laws_file import laws_text
from diagnosis.corrected.mjcf import corrected_mjcf, friction_solver
from diagnosis.effects.parts import PlacedEffect
from diagnosis.replay.replay import replay
from diagnosis.residuals.replays import variants_of

TICK_S = 0.01


def model_of(*effects):
    return tuple(PlacedEffect(name, place, values) for name, place, *values in effects)


def module_of(text):
    """The file, run in a module of its own; no other module knows it."""
    module = ModuleType("corrected_laws")
    module.__file__ = "corrected_laws.py"
    sys.modules[module.__name__] = module  # dataclasses look themselves up
    exec(compile(text, "corrected_laws.py", "exec"), vars(module))
    return module


def commanded(plant, duration_s=1.5, servo=None, size=1.0):
    time_s = ticks(duration_s)
    command = np.repeat(size * smooth_command(time_s), len(plant.joints))
    trace = trace_of(plant, time_s, command_rad=command)
    return run_from(replace(trace, servo=servo or plant.servo))


def stepped(plant, model, run, step_s, without_laws=False):
    """Positions and speeds (T, j) at the rows of a run, of plain MuJoCo's steps."""
    servo = run.trace.servo
    text = corrected_mjcf(plant, model, servo, step_s)
    compiled = mujoco.MjModel.from_xml_string(text)
    compiled.opt.integrator = plant.model.opt.integrator
    compiled.opt.disableflags = plant.model.opt.disableflags
    solver = friction_solver(plant, model, servo, step_s)
    compiled.dof_solref[:], compiled.dof_solimp[:] = solver
    data = mujoco.MjData(compiled)
    for name, angle in zip(plant.joints, run.position_rad, strict=True):
        data.qpos[compiled.joint(name).qposadr[0]] = angle
    if run.base is not None:
        data.qpos[:7], data.qvel[:6] = run.base[:7], run.base[7:]
    module = module_of(laws_text(plant, (*model, UNMOVED), servo))
    return _rolled(plant, run, compiled, data, module, without_laws)


UNMOVED = PlacedEffect("gyro_bias", "gyroscope", (0.1, 0.0, 0.0))
"""Moves no joint, so that there is a file even if MuJoCo has all else."""


def _rolled(plant, run, compiled, data, module, without_laws):
    laws = module.LAWS if not without_laws else ()
    laws = module.CorrectedLaws(compiled, data, module.BACK_EMF_NM_S_RAD, laws)
    start = dict(zip(plant.joints, run.position_rad, strict=True))
    rows = [[(angle, 0.0) for angle in start.values()]]
    per_tick = round(TICK_S / compiled.opt.timestep)
    for command in run.trace.command_rad[:-1]:
        for _ in range(per_tick):
            laws.before_step(dict(zip(plant.joints, command, strict=True)))
            mujoco.mj_step(compiled, data)
        rows.append(list(laws.readings().values()))
    found = np.array(rows)
    return found[:, :, 0], found[:, :, 1]


def compared(plant, model, run, step_s):
    """Largest differences [rad] between file and replay: with laws, and without."""
    (result,) = replay([run], variants_of(plant, [model]), step_s)
    with_laws, _ = stepped(plant, model, run, step_s)
    native, _ = stepped(plant, model, run, step_s, without_laws=True)
    wanted = result.position_rad[0]
    return np.abs(with_laws - wanted).max(), np.abs(native - wanted).max()
