"""Parts of a plant that do not feel each other, replayed each for itself."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from joint_rigs import ARM, plant_of, smooth_command, ticks, trace_of

from diagnosis.effects.library import effect
from diagnosis.effects.parts import PlacedEffect
from diagnosis.replay.replay import replay
from diagnosis.residuals.channels import stacked
from diagnosis.residuals.limbs import limbs_of
from diagnosis.residuals.predictor import Channels, Predictor
from diagnosis.residuals.replays import variants_of
from diagnosis.traces.windows import Run

NAMES = ("upper", "lower", "shoulder", "elbow")


def renamed(xml, tail):
    for name in NAMES:
        xml = xml.replace(f'"{name}"', f'"{name}{tail}"')
    return xml


BESIDE = renamed(ARM, "2").replace('name="upper2"', 'name="upper2" pos="0 1 0"')
JOINTS = ("shoulder", "elbow", "shoulder2", "elbow2")


@pytest.fixture(scope="module")
def arms():
    """Two arms that hang side by side from the world."""
    return plant_of(ARM + BESIDE, kp=8.0, kd=0.3)


def tied(plant):
    """The same with the two shoulders on one shaft."""
    spec = plant.spec.copy()
    tie = spec.add_equality()
    tie.type = mujoco.mjtEq.mjEQ_JOINT
    tie.name1, tie.name2 = "shoulder", "shoulder2"
    tie.objtype = mujoco.mjtObj.mjOBJ_JOINT
    tie.data[:2] = 0.0, 1.0
    return replace(plant, spec=spec)


def touching(plant):
    """The same with shapes that may touch."""
    spec = plant.spec.copy()
    for name in ("lower", "lower2"):
        spec.body(name).add_geom(size=[0.02, 0, 0], mass=0)
    return replace(plant, spec=spec)


def moved(plant):
    time_s = ticks(1.0)
    command = np.outer(smooth_command(time_s), (1.0, -0.5, 0.8, 0.4))
    return trace_of(plant, time_s, 0.9 * command, command_rad=command)


def test_arms_that_hang_side_by_side_are_two_parts(arms):
    assert arms.joints == JOINTS
    assert [limb.plant.joints for limb in limbs_of(arms)] == [JOINTS[:2], JOINTS[2:]]


@pytest.mark.parametrize("joined", [tied, touching])
def test_what_feels_each_other_is_one_part(arms, joined):
    (limb,) = limbs_of(joined(arms))
    assert limb.plant.joints == JOINTS


@pytest.mark.parametrize(
    "model",
    [
        (),
        (PlacedEffect("viscous_friction", "elbow2", (0.2,)),),
        (PlacedEffect("payload_mass", "lower", (0.3,)),),
        (
            PlacedEffect("command_latency", "commands", (0.013,)),
            PlacedEffect("coulomb_friction", "shoulder", (0.1,)),
            PlacedEffect("backlash", "elbow2", (0.05,)),
        ),
    ],
)
def test_parts_move_as_they_do_in_the_whole(arms, model):
    trace = moved(arms)
    names = tuple(f"position.{joint}" for joint in arms.joints)
    channels = Channels(names, np.full(4, 1e-3))
    predictor = Predictor(arms, [trace], channels)
    models = [(), model]
    for by_parts, own in zip(predictor.predict(models), models, strict=True):
        finer = max((effect(one.name).finer for one in own), default=1)
        step_s = predictor.step_s / finer
        (whole,) = replay([Run.of(trace)], variants_of(arms, [own]), step_s)
        np.testing.assert_allclose([by_parts], stacked(whole, channels), atol=1e-9)


def test_in_the_midst_of_a_motion_parts_begin_as_the_whole_does(arms):
    """Integral terms begin with what the acceleration of each joint needs."""
    trace = moved(arms).part(30, 90)
    channels = Channels(
        tuple(f"position.{joint}" for joint in arms.joints), np.full(4, 1e-3)
    )
    predictor = Predictor(arms, [trace], channels)
    model = (PlacedEffect("integral_term", "elbow2", (0.5,)),)
    (by_parts,) = predictor.predict([model])
    run = Run.of(trace)
    variants = variants_of(arms, [model])
    (whole,) = replay([run], variants, predictor.step_s)
    np.testing.assert_allclose([by_parts], stacked(whole, channels), atol=1e-9)
    steady = replace(run, acceleration_rad_s2=None)
    (other,) = replay([steady], variants, predictor.step_s)
    assert np.abs(stacked(other, channels)[0] - by_parts)[:, 3].max() > 1e-4


def test_an_effect_changes_only_its_own_part(arms):
    """Of the two arms, the one that it is on; a delay of all commands changes both."""
    names = tuple(f"position.{joint}" for joint in arms.joints)
    predictor = Predictor(arms, [moved(arms)], Channels(names, np.full(4, 1e-3)))
    plain, one, every = predictor.predict(
        [
            (),
            (PlacedEffect("viscous_friction", "elbow2", (0.2,)),),
            (PlacedEffect("command_latency", "commands", (0.013,)),),
        ]
    )
    assert (one[:, :2] == plain[:, :2]).all()
    assert np.abs(one[:, 2:] - plain[:, 2:]).max() > 1e-3
    assert np.abs(every - plain).max(axis=0).min() > 1e-3
