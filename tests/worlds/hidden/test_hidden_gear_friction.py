"""Hidden friction of loaded gears: what slides, what sticks, and what is refused."""

import numpy as np
import pytest

from groundwalk.errors import BadValueError
from worlds.hidden.effects import KINDS, Hidden
from worlds.hidden.effects.gear_friction import GearFriction, Sides
from worlds.hidden.effects.kind import StiffContact
from worlds.hidden.engine import check_engine
from worlds.hidden.plant import hidden_plant
from worlds.real.hidden_robot import hidden_engine

INERTIA, STEP_S = 0.05, 0.00025


def test_opposed_sides_press_together_and_others_relieve_each_other():
    sides = Sides(of_links=0.1, of_motor=0.2, square_1_nm=0.5)
    assert sides.friction_nm(-3.0, 2.0) == pytest.approx(0.3 + 0.4 + 0.5 * 4.0)
    assert sides.friction_nm(-1.0, 2.0) == pytest.approx(0.1 + 0.4 + 0.5 * 1.0)
    assert sides.friction_nm(3.0, 2.0) == pytest.approx(0.1)


def pushed(servo_nm, links_nm, speed=0.0, **terms):
    """Speed and angle of a mass after a second under two torques and friction."""
    contact = StiffContact(INERTIA, STEP_S, links_nm=lambda: links_nm)
    rubs = GearFriction.of(contact, links_nm=contact.links_nm, **terms)
    angle = 0.0
    for step in range(round(1 / STEP_S)):
        rub_nm = rubs.torque(step * STEP_S, angle, speed, servo_nm)
        speed += (servo_nm + links_nm + rub_nm) / INERTIA * STEP_S
        angle += speed * STEP_S
    return speed, angle


def test_a_motor_needs_its_load_and_the_shares_of_both():
    """Under -2 N m, shares of 0.1: |T - 2| = 0.1 (T + 2) at 2.444 and 1.636 N m."""
    terms = {"always": Sides(0.1, 0.1), "coulomb_nm": 0.0}
    assert abs(pushed(2.43, -2.0, **terms)[1]) < 1e-3
    assert pushed(2.47, -2.0, **terms)[1] > 0.05
    assert abs(pushed(1.65, -2.0, **terms)[1]) < 1e-3
    assert pushed(1.61, -2.0, **terms)[1] < -0.05
    speed, _ = pushed(3.0, -2.0, **terms)
    assert speed == pytest.approx((1.0 - 0.5) / INERTIA, rel=1e-2)


def test_the_peak_drops_with_its_exponent():
    """Friction at w = v is coulomb + extra / e for every exponent, at 2 v it is not."""
    for exponent in (1.0, 2.0, 4.0):
        contact = StiffContact(INERTIA, STEP_S)
        rubs = GearFriction.of(
            contact, coulomb_nm=0.1, extra_nm=0.2, speed_rad_s=0.5, exponent=exponent
        )
        for times in (1.0, 2.0):
            wanted = 0.1 + 0.2 * np.exp(-(times**exponent))
            assert rubs.sliding_nm(-0.5 * times, 9.0) == pytest.approx(wanted)


@pytest.mark.parametrize("engine", ["mujoco", "bullet"])
def test_both_engines_know_what_the_links_weigh(engine):
    """0.5 kg at 0.3 m pull a pendulum back to where it hangs."""
    plant = hidden_plant("pendulum")
    world = hidden_engine(engine, plant, [], STEP_S, None)
    world.reset(np.array([0.7]), 0.0)
    found = world.links_nm()
    world.close()
    np.testing.assert_allclose(found, [-0.5 * 9.81 * 0.3 * np.sin(0.7)], rtol=1e-3)


def loaded():
    """Texts of all rungs that need to know the load, on a knee."""
    for name, kind in KINDS.items():
        if kind.fixed_base_only:
            values = ",".join(f"{one.name}={0.2 + one.low}" for one in kind.quantities)
            yield f"{name}@LKneePitch:{values}"


def test_feet_are_refused_since_the_ground_loads_gears_too():
    every = [Hidden.parse(text) for text in loaded()]
    assert len(every) == 4
    check_engine("bullet", every, floating=False)
    for one in every:
        with pytest.raises(BadValueError, match="needs a fixed base"):
            check_engine("mujoco", [one], floating=True)
