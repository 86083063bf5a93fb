"""Effects on bodies and signals: MuJoCo's torques against closed forms, and sums."""

import mujoco
import numpy as np
import pytest
from joint_rigs import ARM as LINKS
from joint_rigs import SLED, WHEEL, plant_of

from diagnosis.effects.library import effect
from diagnosis.effects.variants import Push, Variants
from diagnosis.plant.plant import Plant
from diagnosis.plant.servo import Servo

GRAVITY, MASS_KG, CENTRE_M = 9.81, 2.0, np.array([0.3, 0.0, -0.1])
CENTRAL_INERTIA = 0.02
ARM = """
<mujoco><worldbody><body name="arm" simple="false"><joint name="hinge" axis="0 1 0"/>
  <inertial pos="{centre}" mass="2" diaginertia=".01 .02 .015"/>
  <geom name="shape" size=".01" pos="{centre}" contype="0" conaffinity="0"/>
  <site name="marker" pos="{centre}"/></body></worldbody>
  <actuator><general name="hinge" joint="hinge"/></actuator></mujoco>"""


def arm(centre="0.3 0 -0.1"):
    servo = Servo(*(np.array([value]) for value in (20.0, 0.5, 3.0, 0.0)))
    spec = mujoco.MjSpec.from_string(ARM.format(centre=centre))
    return Plant("arm", spec, ("hinge",), servo)


def changed(plant, *effects):
    """Row 0 as it is, row 1 with effects (name, place, *values)."""
    variants = Variants(plant, 2)
    for name, place, *values in effects:
        effect(name).apply(variants, 1, place, np.array(values, float))
    return variants


def at_rest(variants, row):
    """Model and data of a row at angle 0."""
    model = variants.plant.spec.compile()
    for name, values in variants.fields.items():
        target = model.opt if name.startswith("opt.") else model
        array = getattr(target, name.removeprefix("opt."))
        array[...] = values[row].reshape(array.shape)
    data = mujoco.MjData(model)
    mujoco.mj_setConst(model, data)
    mujoco.mj_forward(model, data)
    return model, data


def torque_and_inertia(variants, row):
    """Torque of gravity about the hinge, and inertia about it, by MuJoCo."""
    model, data = at_rest(variants, row)
    whole = np.zeros((1, 1))
    mujoco.mj_fullM(model, data, whole)
    return -data.qfrc_bias[0], whole[0, 0]


def expected(mass, centre):
    """The same by hand: m g x turns an arm along +x downwards, which is +y."""
    x, _, z = centre
    return mass * GRAVITY * x, CENTRAL_INERTIA + mass * (x**2 + z**2)


def test_a_payload_pulls_and_resists():
    payloads = [("payload_mass", "arm", 0.5), ("payload_mass", "arm", 0.25)]
    variants = changed(arm(), *payloads)
    np.testing.assert_allclose(
        torque_and_inertia(variants, 1), expected(2.75, CENTRE_M), rtol=1e-9
    )
    np.testing.assert_allclose(
        torque_and_inertia(variants, 0), expected(MASS_KG, CENTRE_M), rtol=1e-9
    )


@pytest.mark.parametrize("centre", [(0.3, 0.0, -0.1), (0.0, 0.0, 0.0)])
def test_the_centre_of_mass_moves(centre):
    plant = arm(" ".join(map(str, centre)))
    offsets = [("com_offset", "arm", 0.02, 0, 0), ("com_offset", "arm", 0, 0.01, 0.03)]
    variants = changed(plant, *offsets)
    np.testing.assert_allclose(
        torque_and_inertia(variants, 1),
        expected(MASS_KG, np.add(centre, (0.02, 0.01, 0.03))),
        rtol=1e-9,
        atol=1e-12,
    )
    np.testing.assert_allclose(
        torque_and_inertia(variants, 0), expected(MASS_KG, centre), atol=1e-12
    )


@pytest.mark.parametrize("centre", ["0.3 0 -0.1", "0 0 0"])
def test_shapes_stay_where_they_are(centre):
    variants = changed(arm(centre), ("com_offset", "arm", 0.02, 0.01, 0.03))
    (_, before), (_, after) = at_rest(variants, 0), at_rest(variants, 1)
    assert np.allclose(before.geom_xpos, after.geom_xpos, atol=1e-12)
    assert np.allclose(before.site_xpos, after.site_xpos, atol=1e-12)
    assert not np.allclose(before.xipos, after.xipos)


def test_offset_and_payload_in_one_row():
    effects = [("com_offset", "arm", 0.1, 0, 0), ("payload_mass", "arm", 1.0)]
    wanted = expected(3.0, np.add(CENTRE_M, (0.1, 0, 0)))
    for order in (effects, effects[::-1]):
        variants = changed(arm(), *order)
        np.testing.assert_allclose(torque_and_inertia(variants, 1), wanted, rtol=1e-9)


@pytest.mark.parametrize(("pitch", "roll"), [(0.2, 0.0), (0.0, 0.2), (0.1, -0.3)])
def test_a_tilted_base_feels_gravity_from_the_side(pitch, roll):
    variants = changed(arm(), ("ground_slope", "world", pitch, roll))
    gravity = variants.fields["opt.gravity"]
    # The third row of R_y(pitch) R_x(roll): the world's z axis in the base's frame
    up = [-np.sin(pitch), np.cos(pitch) * np.sin(roll), np.cos(pitch) * np.cos(roll)]
    np.testing.assert_allclose(gravity[1], -GRAVITY * np.array(up), atol=1e-12)
    np.testing.assert_array_equal(gravity[0], [0, 0, -GRAVITY])


def test_two_tilts_about_one_axis_add():
    twice = [("ground_slope", "world", 0.1, 0), ("ground_slope", "world", 0.05, 0)]
    gravity = changed(arm(), *twice).fields["opt.gravity"][1]
    np.testing.assert_allclose(
        gravity, [GRAVITY * np.sin(0.15), 0, -GRAVITY * np.cos(0.15)], atol=1e-12
    )


def test_pushes_are_listed():
    first, second = (1, 0, 0, 0.5, 0.2), (0, 2, 0, 1.0, 0.1)
    none = (0, 2, 0, 1.0, 0.0)
    effects = [("external_force", "arm", *push) for push in (first, none, second)]
    pushes = changed(arm(), *effects).outside.pushes
    assert pushes == [
        [],
        [Push("arm", (1, 0, 0), 0.5, 0.2), Push("arm", (0, 2, 0), 1.0, 0.1)],
    ]


def test_drag_adds_at_its_body():
    plant = arm()
    drags = changed(plant, ("drag", "arm", 1.0), ("drag", "arm", 0.5)).outside
    body = plant.model.body("arm").id
    wanted = np.zeros((2, plant.model.nbody))
    wanted[1, body] = 1.5
    np.testing.assert_array_equal(drags.drag_n_s_m, wanted)


def test_signals_add():
    signals = changed(
        arm(),
        ("command_latency", "commands", 0.01),
        ("command_latency", "commands", 0.02),
        ("sensor_delay", "encoders", 0.003),
        ("sensor_delay", "encoders", 0.004),
        ("gyro_bias", "gyroscope", 0.1, 0, 0),
        ("gyro_bias", "gyroscope", 0, 0.2, -0.3),
    ).signals
    np.testing.assert_allclose(signals.command_delay_s, [0, 0.03])
    np.testing.assert_allclose(signals.sensor_delay_s, [0, 0.007])
    np.testing.assert_allclose(signals.gyro_bias_rad_s, [[0, 0, 0], [0.1, 0.2, -0.3]])


def test_uneven_grounds_add():
    place = ("uneven_ground", "world")
    bumps = changed(arm(), (*place, 0.01), (*place, 0.02)).outside
    np.testing.assert_allclose(bumps.bump_height_m, [0, 0.03])


def test_forces_are_measured_by_the_weight():
    plant = arm()
    x, *_ = effect("external_force").parameters(plant, "arm")
    assert 0.005 * 9.81 * MASS_KG <= x.typical <= 0.1 * 9.81 * MASS_KG
    (payload,) = effect("payload_mass").parameters(plant, "arm")
    assert 0.01 * MASS_KG <= payload.typical <= 0.3 * MASS_KG


STACK = """
<mujoco><worldbody><body name="cube" pos="1 0 0"><freejoint/>
    <geom type="box" size=".1 .1 .1"/></body>
  <body name="cart"><joint name="slide" type="slide" axis="1 0 0"/>
    <geom type="box" size=".1 .1 .1"/>
    <body name="wheel" simple="false"><joint name="axle" axis="0 1 0"/>
      <geom type="box" size=".1 .1 .1"/></body></body></worldbody></mujoco>"""


def stack():
    spec = mujoco.MjSpec.from_string(STACK)
    return Plant("stack", spec, ("slide", "axle"), Servo.ideal(2))


def test_simple_bodies_keep_their_centre():
    assert effect("com_offset").places(stack(), []) == ("cart", "wheel")
    assert effect("payload_mass").places(stack(), []) == ("cube", "cart", "wheel")


def test_an_offset_couples_a_wheel_to_its_cart():
    plant = stack()
    variants = changed(plant, ("com_offset", "wheel", 0, 0, 0.05))
    model, data = at_rest(variants, 1)
    whole = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, whole)
    slide, axle = plant.dofs
    mass = 1000 * 0.2**3
    assert whole[slide, axle] == pytest.approx(mass * 0.05)
    assert whole[axle, axle] == pytest.approx(mass * (0.2**2 / 6 + 0.05**2))


def test_a_payload_on_a_body_that_turns_about_its_centre():
    variants = changed(arm("0 0 0"), ("payload_mass", "arm", 1.0))
    _, inertia = torque_and_inertia(variants, 1)
    assert inertia == pytest.approx(CENTRAL_INERTIA)
    slide = stack()
    variants = changed(slide, ("payload_mass", "cart", 1.0))
    model, data = at_rest(variants, 1)
    whole = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, whole)
    assert whole[slide.dofs[0], slide.dofs[0]] == pytest.approx(17.0)


@pytest.mark.parametrize(
    ("body", "places"),
    [
        pytest.param(SLED, (), id="a slide's own friction"),
        pytest.param(LINKS, ("lower",), id="the first link's, too"),
    ],
)
def test_drag_is_where_it_is_not_the_friction_of_one_joint(body, places):
    plant = plant_of(body)
    assert effect("drag").places(plant, ()) == places
    assert set(effect("external_force").places(plant, ())) >= set(places)


def test_viscous_friction_is_measured_by_how_joints_are_used():
    slide, hinge = (
        effect("viscous_friction").parameters(plant_of(body, kp=100.0), joint)[0]
        for body, joint in ((SLED, "slide"), (WHEEL, "hinge"))
    )
    # slides are ten times as slow: metres, not radians
    assert slide.high == pytest.approx(10 * hinge.high)


def test_a_payload_may_be_heavier_than_the_robot_that_carries_it():
    plant = plant_of(LINKS)
    own = [float(plant.model.body(name).mass[0]) for name in ("upper", "lower")]
    (mass,) = effect("payload_mass").parameters(plant, "lower")
    assert mass.high > 3 * sum(own)


def test_a_robot_may_lack_a_part_of_a_body_but_not_all_of_it():
    plant = arm()
    (mass,) = effect("payload_mass").parameters(plant, "arm")
    assert mass.low == pytest.approx(-0.9 * MASS_KG)
    lighter = changed(plant, ("payload_mass", "arm", -0.5 * MASS_KG))
    whole, half = (torque_and_inertia(lighter, row)[0] for row in (0, 1))
    assert half == pytest.approx(0.5 * whole)


def test_inertia_of_a_link_without_its_weight():
    turned = ("link_inertia", "arm", 3.0), ("link_inertia", "arm", 0.5)
    torque, inertia = expected(MASS_KG, CENTRE_M)
    for rows, factor in ((turned, 1.5), (turned[:1], 3.0)):
        found = torque_and_inertia(changed(arm(), *rows), 1)
        wanted = torque, inertia + (factor - 1) * CENTRAL_INERTIA
        np.testing.assert_allclose(found, wanted, rtol=1e-9)


ELBOW = """
<mujoco><worldbody><body name="cube" pos="1 0 0"><freejoint/>
    <geom type="box" size=".1 .1 .1"/></body>
  <body name="upper"><joint name="shoulder" axis="0 1 0"/>
    <geom type="box" size=".1 .1 .1" pos=".1 0 0"/>
    <body name="lower" pos=".3 0 0"><joint name="elbow" axis="0 1 0"/>
      <geom type="box" size=".1 .1 .1" pos=".1 0 0"/></body></body>
</worldbody></mujoco>"""


def test_inertia_of_a_body_is_tried_where_two_joints_turn_it():
    """On one hinge it is rotor inertia; of a simple body MuJoCo keeps it fixed."""
    inertia = effect("link_inertia")
    assert inertia.places(stack(), []) == ()
    spec = mujoco.MjSpec.from_string(ELBOW)
    plant = Plant("elbow", spec, ("shoulder", "elbow"), Servo.ideal(2))
    assert inertia.places(plant, []) == ("lower",)
    variants, matrices = changed(plant, ("link_inertia", "lower", 2.0)), []
    for row in (0, 1):
        whole = np.zeros((8, 8))
        mujoco.mj_fullM(*at_rest(variants, row), whole)
        matrices.append(whole[np.ix_(plant.dofs, plant.dofs)])
    own = 1000 * 0.2**3 * 0.2**2 / 6  # not only on the diagonal, as a rotor's would be
    np.testing.assert_allclose(matrices[1] - matrices[0], own, rtol=1e-9)
