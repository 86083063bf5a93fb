"""Recordings of a sim whose dry friction lets joints creep, and of one that stops."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from joint_rigs import (
    PENDULUM,
    exact,
    plant_of,
    run_from,
    smooth_command,
    ticks,
    trace_of,
)

from diagnosis.conclude.soft_friction import creeps, rubs, softly
from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.channels import Channels
from diagnosis.residuals.predictor import Predictor

KP, KD, FRICTION_NM, NOISE_RAD = 8.0, 0.3, 0.25, 1e-4
PLANT = plant_of(PENDULUM, kp=KP, kd=KD)
TRUTH = (PlacedEffect("coulomb_friction", "hinge", (FRICTION_NM,)),)
CHANNELS = Channels(("position.hinge",), np.array([NOISE_RAD]))
LEAST = 20.0


def by_mujoco(duration_s=4.0, step_s=1e-4):
    """A trace of MuJoCo itself, with its usual friction solver."""
    spec = PLANT.spec.copy()
    spec.joint("hinge").frictionloss = FRICTION_NM
    model = spec.compile()
    model.opt.timestep = step_s
    data, time_s = mujoco.MjData(model), ticks(duration_s, 0.02)
    command, position = smooth_command(time_s), np.zeros(len(time_s))
    for k in range(len(time_s)):
        position[k] = data.qpos[0]
        for _ in range(round(0.02 / step_s)):
            pull_nm = KP * (command[k] - data.qpos[0]) - KD * data.qvel[0]
            data.qfrc_applied[0] = pull_nm
            mujoco.mj_step(model, data)
    position += NOISE_RAD * np.random.default_rng(0).standard_normal(len(time_s))
    return trace_of(PLANT, time_s, position, command_rad=command)


def by_stopping_friction():
    """A trace of this project's replay, in which friction stops a joint."""
    effect = ("coulomb_friction", "hinge", FRICTION_NM)
    time_s = ticks(4.0, 0.02)
    command = smooth_command(time_s)
    asked = trace_of(PLANT, time_s, command_rad=command)
    truth = exact(PLANT, run_from(asked), effect, step_s=2.5e-4)[:, 0]
    noise = NOISE_RAD * np.random.default_rng(0).standard_normal(len(truth))
    return trace_of(PLANT, time_s, truth + noise, command_rad=command)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("recording", "soft"), [(by_mujoco, True), (by_stopping_friction, False)]
)
def test_the_friction_that_the_recordings_have_is_taken(recording, soft):
    learned = Predictor(PLANT, [recording()], CHANNELS, 1e-3)
    learned.calibrate()
    assert creeps(learned, TRUTH, LEAST) is soft


def test_where_nothing_rubs_nothing_is_asked():
    assert not rubs(PLANT)
    assert rubs(PLANT, TRUTH)
    spec = PLANT.spec.copy()
    spec.joint("hinge").frictionloss = 0.1
    assert rubs(replace(PLANT, spec=spec))
    assert softly(PLANT).creeps
    assert not PLANT.creeps
