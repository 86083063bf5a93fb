"""Uneven ground in replays: it is where loaded soles stood, if it may be that high."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from joint_rigs import servo_of
from swinger_rig import KD, KP, swinger

from diagnosis.effects.parts import PlacedEffect
from diagnosis.plant.plant import Plant
from diagnosis.replay.replay import replay
from diagnosis.residuals.replays import variants_of
from diagnosis.traces.trace import Trace
from diagnosis.traces.windows import Run

STAND_M = 0.1 - 0.0002
"""Of the box, with its balls a little in the ground, as they are at rest."""


def stood(height_m=STAND_M, roll_rad=0.0, plant=None, force_n=None):
    """Half a second of standing still, begun from such a pose."""
    plant = plant or swinger()
    time_s = np.arange(50) * 0.01
    none = np.zeros((50, 2))
    trace = Trace("stood", time_s, none, servo_of(2, KP, KD), command_rad=none)
    if force_n is not None:
        trace = replace(trace, foot_force_n=np.tile(force_n, (50, 1)))
    turn = [np.cos(roll_rad / 2), np.sin(roll_rad / 2), 0, 0]
    base = np.array([0, 0, height_m, *turn, *np.zeros(6)])
    return Run(trace, np.zeros(2), np.zeros(2), base)


def last(run, *heights_m, plant=None):
    """(n, 13) base at the end, for each height of the bumps."""
    models = [
        (PlacedEffect("uneven_ground", "world", (height,)),) for height in heights_m
    ]
    variants = variants_of(plant or swinger(), models)
    return replay([run], variants)[0].base[:, -1]


@pytest.mark.parametrize("bump_m", [0.004, -0.004])
def test_a_box_stays_where_it_stood_if_bumps_may_be_so_high(bump_m):
    start = STAND_M + bump_m
    flat, low, high = last(stood(start), 0.0, 0.002, 0.01)[:, 2]
    assert flat == pytest.approx(STAND_M, abs=3e-4)
    assert low == pytest.approx(STAND_M + np.sign(bump_m) * 0.002, abs=4e-4)
    assert high == pytest.approx(start, abs=4e-4)


def test_each_ball_has_its_own_ground():
    tilted = stood(STAND_M, roll_rad=0.03)
    flat, bumpy = last(tilted, 0.0, 0.01)
    assert abs(flat[3:7][1]) < 1e-3
    assert 2 * bumpy[3:7][1] == pytest.approx(0.03, abs=3e-3)


def test_what_the_start_is_not_known_by_is_no_bump():
    flat, bumpy = last(stood(STAND_M + 4e-4), 0.0, 0.01)
    np.testing.assert_array_equal(flat, bumpy)


def test_without_bumps_nothing_changes():
    plain = replay([stood()], variants_of(swinger(), [()]))[0].base
    zero = replay(
        [stood()],
        variants_of(swinger(), [(PlacedEffect("uneven_ground", "world", (0.0,)),)]),
    )[0].base
    np.testing.assert_array_equal(plain, zero)


LEGS = "".join(
    f"""<body name="{name}" pos="0 {y} 0"><joint name="{name}" axis="0 1 0"/>
    <geom type="box" size=".05 .03 .01" pos="0 0 -.09" mass=".5" conaffinity="0"/>
    </body>"""
    for name, y in (("left", 0.05), ("right", -0.05))
)
BIPED = f"""<mujoco>
  <option integrator="implicitfast"><flag autoreset="disable"/></option>
  <worldbody><geom name="ground" type="plane" size="0 0 1" contype="0"/>
  <body name="hips" pos="0 0 .1"><freejoint name="root"/>
  <inertial pos="0 0 0" mass="3" diaginertia=".02 .02 .03"/>{LEGS}</body>
  </worldbody><actuator><general name="left" joint="left" biastype="affine"/>
  <general name="right" joint="right" biastype="affine"/></actuator></mujoco>"""


@pytest.mark.parametrize(
    ("force_n", "stays"), [(None, True), ((30.0, 0.0), True), ((0.0, 0.0), False)]
)
def test_there_is_ground_only_under_feet_that_carry(force_n, stays):
    spec = mujoco.MjSpec.from_string(BIPED)
    feet = ("left", "right")
    plant = Plant("biped", spec, feet, servo_of(2, KP, KD), "floating", feet)
    run = stood(0.104, plant=plant, force_n=force_n)
    height_m = last(run, 0.01, plant=plant)[0, 2]
    if force_n is None:
        assert height_m == pytest.approx(0.104, abs=5e-4)
    elif stays:  # on the left foot only: it tips over to the right
        assert height_m < 0.1039
    else:
        assert height_m == pytest.approx(0.1, abs=5e-4)
