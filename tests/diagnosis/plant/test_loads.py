"""Loads of recordings, against models into which MuJoCo's compiler has put them."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from joint_rigs import plant_of, trace_of

from diagnosis.effects.parts import PlacedEffect
from diagnosis.effects.scales import inertia_kg_m2, mass_kg
from diagnosis.plant.loads import model_under
from diagnosis.plant.plant import inverse_dynamics
from diagnosis.replay.inverse import NeededTorques
from diagnosis.replay.replay import replay
from diagnosis.residuals.replays import variants_of
from diagnosis.traces.motion import Motion
from diagnosis.traces.windows import Run
from worlds import Load

UPPER, HAND = Load(0.7, (0.05, -0.02, 0.3)), Load(1.5, (0.2, 0.1, -0.15))
LOADS = {"upper": UPPER, "hand": HAND}


def arm_xml(loads=(), simple=True):
    """MJCF of an arm with turned inertias; loads are bodies of their own."""
    extra = {
        name: f'<body pos="{" ".join(map(str, one.at))}"><inertial pos="0 0 0" '
        f'mass="{one.mass}" diaginertia="0 0 0"/></body>'
        for name, one in dict(loads).items()
    }
    place = "" if simple else 'quat="0.9 0.3 0.1 -0.2"'
    centre = "0 0 0" if simple else "0.03 0.01 0.2"
    hand, turn = ("0 0 0", "") if simple else ("0 .02 .1", 'quat="1 1 0 0"')
    return f"""<body name="upper"><joint name="one" axis="0 1 0"/>
      <inertial pos="{centre}" mass="2" diaginertia=".03 .02 .015" {place}/>
      {extra.get("upper", "")}
      <body name="hand" pos="0 0 .5"><joint name="two" axis="1 0 0"/>
      <inertial pos="{hand}" mass=".5" diaginertia=".004 .003 .002" {turn}/>
      {extra.get("hand", "")}</body></body>"""


def arm(loads=(), simple=True):
    """The arm with position servos."""
    return plant_of(arm_xml(loads, simple), kp=50.0, kd=3.0)


@pytest.fixture(params=[True, False], ids=["simple", "turned"])
def simple(request):
    """Whether the bodies have their centres of mass at their joints."""
    return request.param


def bare(simple, *loads):
    return arm(simple=simple).bearing(loads)


def needed(plant, model, seed=1):
    rng = np.random.default_rng(seed)
    return inverse_dynamics(plant, model, *rng.uniform(-2, 2, (3, 20, 2)))


def test_a_model_with_loads_moves_as_one_that_has_them(simple):
    plant, truth = bare(simple, LOADS), arm(LOADS, simple)
    right = needed(truth, truth.model)
    np.testing.assert_allclose(needed(plant, model_under(plant, LOADS)), right)
    assert np.abs(needed(plant, plant.model) - right).max() > 1.0
    assert model_under(plant, {}) is plant.model


WHEEL = """<body name="wheel"><joint name="hub" axis="0 1 0"/>
  <inertial pos="0 0 0" mass="1" diaginertia=".1 .1 .1"/></body>"""


def test_a_wheel_that_mujoco_takes_for_simple_can_carry_one():
    loads = {"wheel": Load(2.0, (0.5, 0.0, 0.0))}
    wheel = plant_of(WHEEL)
    with pytest.raises(mujoco.FatalError, match="simple"):
        model_under(wheel, loads)
    wheel = wheel.bearing([loads])
    still, turning = np.zeros((1, 1)), np.ones((1, 1))
    model = model_under(wheel, loads)
    torque = inverse_dynamics(wheel, model, still, still, turning)
    # inertia 0.1 + 2 * 0.5^2, gravity against the axis y at +x
    np.testing.assert_allclose(torque, 0.6 - 2 * 9.81 * 0.5)


def traces(plant):
    """Two traces of the same motion, the second with loads."""
    time_s = np.arange(60) * 0.02
    swing = np.stack([0.5 * np.sin(5 * time_s), 0.3 * np.cos(4 * time_s)], axis=1)
    first = replace(trace_of(plant, time_s), position_rad=swing, command_rad=swing)
    return [first, replace(first, name="loaded", loads=LOADS)]


def test_each_replay_carries_the_loads_of_its_recording(simple):
    plant, truth = bare(simple, LOADS), arm(LOADS, simple)
    models = [(), (PlacedEffect("payload_mass", "hand", (0.4,)),)]
    runs = [Run.of(one) for one in traces(plant)]
    free, loaded = replay(runs, variants_of(plant, models))
    own = Run.of(traces(truth)[0])
    (right,) = replay([own], variants_of(truth, models))
    (without,) = replay([own], variants_of(arm(simple=simple), models))
    assert loaded.position_rad == pytest.approx(right.position_rad, abs=1e-9)
    assert free.position_rad == pytest.approx(without.position_rad, abs=1e-9)
    assert np.abs(loaded.position_rad - free.position_rad).max() > 0.01
    changes = np.ptp(loaded.position_rad, axis=0).max()
    assert changes > 0.001  # the payload beside the load


def test_the_torques_that_a_motion_needs_are_those_with_its_loads(simple):
    plant, truth = bare(simple, LOADS), arm(LOADS, simple)
    rng = np.random.default_rng(2)
    moved = rng.uniform(-1, 1, (3, 60, 2))

    def moving(plant, loads):
        ones = np.ones(2)
        motion = Motion(*moved, np.ones((60, 2), bool), 1, ones, ones)
        return replace(
            trace_of(plant, np.arange(60) * 0.02), motion=motion, loads=loads
        )

    both = NeededTorques(plant, [moving(plant, {}), moving(plant, LOADS)])
    found = both.of(variants_of(plant, [()]))[0]
    right = NeededTorques(truth, [moving(truth, {})]).of(variants_of(truth, [()]))[0]
    without = needed_without(simple, moved)
    np.testing.assert_allclose(found[60:], right, atol=1e-9)
    np.testing.assert_allclose(found[:60], without, atol=1e-9)


def needed_without(simple, moved):
    plant = arm(simple=simple)
    return inverse_dynamics(plant, plant.model, *moved)


def test_bounds_are_for_the_robot_with_its_heaviest_load(simple):
    plant, light = bare(simple, LOADS, {"hand": Load(0.1, HAND.at)}), bare(simple)
    truth = arm(LOADS, simple)
    assert mass_kg(plant) == pytest.approx(mass_kg(truth))
    for joint in plant.joints:
        assert inertia_kg_m2(plant, joint) == pytest.approx(inertia_kg_m2(truth, joint))
        assert inertia_kg_m2(light, joint) < inertia_kg_m2(truth, joint)


def test_a_limb_without_the_body_has_no_load(simple):
    plant = bare(simple)
    model = model_under(plant, {"another arm's hand": UPPER})
    np.testing.assert_allclose(needed(plant, model), needed(plant, plant.model))
