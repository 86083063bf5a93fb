"""All effects: their names, their neutral values, one row at a time."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from joint_rigs import ARM, WHEEL, plant_of, servo_of, trace_of

from diagnosis.effects.library import all_effects, effect
from diagnosis.effects.parts import PlacedEffect
from diagnosis.effects.variants import Variants
from diagnosis.plant.plant import Plant
from diagnosis.plant.servo import Servo
from diagnosis.traces.motion import Motion
from diagnosis.traces.trace import Trace
from groundwalk.errors import UnknownNameError

# As fixed in the specification of the room.
PARAMETERS = {
    "viscous_friction": "coefficient",
    "coulomb_friction": "torque",
    "stribeck_friction": "coulomb_torque extra_torque speed",
    "load_friction": "share",
    "presliding": "torque reach",
    "angle_friction": "torque factor",
    "shaped_stribeck_friction": "coulomb_torque extra_torque speed exponent",
    "gear_friction": "coulomb_torque share",
    "gear_stribeck_friction": "coulomb_torque extra_torque speed exponent "
    "share extra_share",
    "directional_gear_friction": "coulomb_torque extra_torque speed exponent "
    "link_share motor_share extra_link_share extra_motor_share",
    "quadratic_gear_friction": "coulomb_torque extra_torque speed exponent "
    "link_share motor_share extra_link_share extra_motor_share extra_square",
    "backlash": "gap",
    "joint_elasticity": "stiffness damping",
    "command_latency": "delay",
    "sensor_delay": "delay",
    "late_reading": "delay",
    "encoder_offset": "offset",
    "gyro_bias": "x y z",
    "torque_limit": "torque",
    "speed_limit": "speed",
    "acceleration_limit": "acceleration",
    "servo_gain": "factor",
    "servo_damping": "factor",
    "integral_term": "time",
    "dead_band": "width",
    "error_derivative": "share",
    "armature": "inertia",
    "payload_mass": "mass",
    "com_offset": "x y z",
    "link_inertia": "factor",
    "joint_spring": "stiffness rest",
    "torque_offset": "torque",
    "cogging": "torque per_turn phase",
    "end_stop": "angle side",
    "servo_fade": "rate",
    "servo_off": "share start duration",
    "supply_sag": "share",
    "contact_friction": "coefficient",
    "contact_compliance": "stiffness",
    "ground_slope": "pitch roll",
    "uneven_ground": "height",
    "external_force": "x y z start duration",
    "drag": "coefficient",
    "torque_scale": "factor",
}

WALKER = """
<mujoco><worldbody><geom name="ground" type="plane" size="1 1 1"/>
  <body name="trunk" pos="0 0 .5"><freejoint name="root"/>
    <geom size=".1" mass="2" contype="0" conaffinity="0"/>
    <body name="left"><joint name="hip" axis="0 1 0" range="-1 1"/>
      <geom type="box" size=".1 .05 .01" pos="0 .1 -.3" mass=".5"/></body>
    <body name="right"><joint name="knee" axis="0 1 0"/>
      <geom type="box" size=".1 .05 .01" pos="0 -.1 -.3" mass=".5"/></body>
    <body><geom size=".01" mass=".1" contype="0" conaffinity="0"/></body>
  </body></worldbody>
  <actuator><general name="hip" joint="hip"/><general name="knee" joint="knee"/>
  </actuator></mujoco>"""


def servo(kp=(20.0, 0.0), kd=(0.5, 0.0), limit=(5.0, np.inf)):
    return Servo(np.array(kp), np.array(kd), np.array(limit), np.zeros(2))


def walker(**changes):
    spec = mujoco.MjSpec.from_string(WALKER)
    given = {"base": "floating", "feet": ("left", "right"), "servo": servo()}
    return Plant("walker", spec, ("hip", "knee"), **(given | changes))


def able(one):
    """A plant that can have this effect."""
    return walker() if one.places(walker(), EVERYTHING) else walker(base="fixed")


def trace(**channels):
    time_s = np.arange(3) * 0.01
    return Trace("test", time_s, np.zeros((3, 2)), servo(), **channels)


def compared():
    """A motion whose torques are compared."""
    zero = np.zeros((3, 2))
    return Motion(zero, zero, zero, zero == 0, 1, np.ones(2), np.ones(2))


EVERYTHING = [
    trace(
        command_rad=np.zeros((3, 2)),
        gyroscope_rad_s=np.zeros((3, 3)),
        motion=compared(),
    )
]


def contents(variants):
    """Everything that an effect can change, by name; lists of pushes as text."""
    arrays = {
        f"{part}.{name}": np.array([str(v) for v in value])
        if name == "pushes"
        else value
        for part in ("joints", "signals", "outside")
        for name, value in vars(getattr(variants, part)).items()
    }
    laws = {f"law.{law.name}": noted for law, noted in variants.torques.items()}
    return arrays | variants.fields | laws


def changed_rows(plant, variants):
    """Rows in which a variant is not bit for bit the plant."""
    nominal = Variants(plant, variants.n)
    for name in variants.fields:
        nominal.field(name)
    rows = set()
    before = contents(nominal)
    for name, value in contents(variants).items():
        usual = before.get(name, np.zeros_like(value))
        same = (value == usual).reshape(variants.n, -1).all(axis=1)
        rows |= set(np.flatnonzero(~same))
    return rows


def test_the_library_is_as_specified():
    names = {
        name: " ".join(
            p.name for p in one.parameters(plant, one.places(plant, EVERYTHING)[0])
        )
        for name, one in all_effects().items()
        for plant in [able(one)]
    }
    assert names == PARAMETERS
    assert list(names) == list(PARAMETERS)


def test_gears_and_stops_may_yield():
    """Each gives way further than the rigid one, where it says so; others are alike."""
    for name, one in all_effects().items():
        plant = able(one)
        place = one.places(plant, EVERYTHING)[0]
        typical = tuple(p.typical for p in one.parameters(plant, place))
        placed = PlacedEffect(name, place, typical)
        softer = one.softer(plant, placed)
        assert softer.values[: len(typical)] == typical
        assert (softer != placed) == (name in {"backlash", "end_stop"})
    plant = walker()
    variants = Variants(plant, 2)
    for row, values in enumerate([(0.02,), (0.02, 1e-3)]):
        effect("backlash").apply(variants, row, "hip", np.array(values))
    for row, values in enumerate([(0.01, 1.0), (0.01, 1.0, 0.03)]):
        effect("end_stop").apply(variants, row, "hip", np.array(values))
    joint = plant.model.joint("hip").id
    at = variants.column("hip")
    assert variants.joints.compliance_rad_nm[:, at].tolist() == [0.0, 1e-3]
    assert variants.field("jnt_solref")[:, joint, 0].tolist() == [0.005, 0.03]


def test_a_wrong_name_is_told_the_nearest():
    assert effect("backlash").name == "backlash"
    with pytest.raises(UnknownNameError, match="'backlash'"):
        effect("backlas")


@pytest.mark.parametrize("name", PARAMETERS)
def test_neutral_values_change_nothing(name):
    one = effect(name)
    plant = able(one)
    variants = Variants(plant, 2)
    for place in one.places(plant, EVERYTHING):
        neutral = np.array([p.neutral for p in one.parameters(plant, place)])
        one.apply(variants, 1, place, neutral)
    assert changed_rows(plant, variants) == set()


@pytest.mark.parametrize("name", PARAMETERS)
def test_typical_values_change_one_row(name):
    one = effect(name)
    plant = able(one)
    for place in one.places(plant, EVERYTHING):
        variants = Variants(plant, 3)
        typical = np.array([p.typical for p in one.parameters(plant, place)])
        one.apply(variants, 1, place, typical)
        assert changed_rows(plant, variants) == {1}


@pytest.mark.parametrize("base", ["fixed", "floating"])
@pytest.mark.parametrize("name", PARAMETERS)
def test_sizes_lie_within_bounds(name, base):
    plant, one = walker(base=base), effect(name)
    for place in one.places(plant, EVERYTHING):
        for parameter in one.parameters(plant, place):
            assert parameter.low < parameter.high
            assert parameter.low <= parameter.typical <= parameter.high
            assert parameter.neutral >= parameter.low
            # Infinite stiffnesses and limits are not there; all others can be reached.
            assert parameter.neutral <= parameter.high or parameter.neutral == np.inf
            assert parameter.low > 0 or not parameter.logarithmic
            assert np.isfinite([parameter.low, parameter.high]).all()


def test_where_effects_may_be():
    plant = walker()
    places = {
        name: one.places(plant, EVERYTHING) for name, one in all_effects().items()
    }
    kinds = {name: one.place_kind for name, one in all_effects().items()}
    for name, kind in kinds.items():
        if kind in ("commands", "encoders", "gyroscope", "feet", "supply", "world"):
            assert places[name] == (kind,)
        elif kind == "body":
            assert places[name] == ("trunk", "left", "right")
    driven = {name for name, found in places.items() if found == ("hip",)}
    assert driven == {
        *("backlash", "servo_gain", "servo_damping", "servo_fade", "servo_off"),
        *("speed_limit", "joint_elasticity", "load_friction"),
        "acceleration_limit",
        *("dead_band", "error_derivative"),
    }
    assert places["torque_limit"] == ("hip", "knee")
    fixed_only = {name for name, found in places.items() if not found}
    assert fixed_only == {
        "integral_term",
        *("gear_friction", "gear_stribeck_friction"),
        *("directional_gear_friction", "quadratic_gear_friction"),
    }
    for name in fixed_only:  # the ground would load gears and servos of legs
        assert effect(name).places(walker(base="fixed"), EVERYTHING) == ("hip",)


def test_only_joints_that_are_driven_have_a_motor():
    """By a servo, or by a torque that is not always 0."""
    passive = walker(servo=servo(kp=(0.0, 0.0)))
    pushed = np.zeros((3, 2))
    pushed[1, 1] = 0.1
    for torque, joints in ((None, ()), (np.zeros((3, 2)), ()), (pushed, ("knee",))):
        own = replace(trace(torque_nm=torque), servo=passive.servo)
        for name in ("joint_elasticity", "servo_off", "load_friction"):
            assert effect(name).places(passive, [own]) == joints
    assert effect("joint_elasticity").places(passive, []) == ()
    assert effect("joint_elasticity").places(walker(), EVERYTHING) == ("hip",)


def test_where_effects_cannot_be():
    fixed, bare = walker(base="fixed"), [trace()]
    none = ("command_latency", "gyro_bias", "speed_limit", "contact_friction")
    none = (*none, "acceleration_limit", "supply_sag")
    controllers = ("integral_term", "dead_band", "error_derivative")
    for name in (
        *none,
        *controllers,
        "contact_compliance",
        "uneven_ground",
        "torque_scale",
    ):
        assert effect(name).places(fixed, bare) == ()
    assert effect("ground_slope").places(fixed, bare) == ("world",)
    assert effect("contact_friction").places(walker(feet=()), bare) == ()
    assert effect("contact_friction").places(walker(), bare) == ("feet",)


def test_limbs_that_are_simulated_apart_have_no_supply_in_common():
    sag, time_s = effect("supply_sag"), np.arange(3) * 0.01
    other = WHEEL.replace('"wheel"', '"other"').replace('"hinge"', '"other"')
    for body, places in ((ARM, ("supply",)), (WHEEL + other, ())):
        plant = plant_of(body, kp=5.0)
        moved = trace_of(plant, time_s, command_rad=np.zeros(2))
        assert sag.places(plant, [moved]) == places
        loose = servo_of(2)
        assert (
            sag.places(replace(plant, servo=loose), [replace(moved, servo=loose)]) == ()
        )


@pytest.mark.parametrize("name", ["integral_term", "dead_band", "error_derivative"])
def test_torques_that_servos_ask_for_tell_nothing_of_their_controllers(name):
    by_servo = replace(compared(), by_servo=True)
    fixed = walker(base="fixed")
    asked = [replace(one, motion=by_servo) for one in EVERYTHING]
    assert effect(name).places(fixed, EVERYTHING) == ("hip",)
    assert effect(name).places(fixed, asked) == ()


def test_without_damping_of_its_own_a_servo_has_none_of_an_error():
    undamped = replace(EVERYTHING[0], servo=servo(kd=(0.0, 0.0)))
    assert effect("error_derivative").places(walker(), [undamped]) == ()
    assert effect("dead_band").places(walker(), [undamped]) == ("hip",)


def test_the_traces_own_servos_count():
    plant = walker(servo=Servo.ideal(2))
    assert effect("backlash").places(plant, EVERYTHING) == ("hip",)
    assert effect("backlash").places(plant, []) == ()


def test_torque_commands_can_be_late():
    by_torque = [trace(command_torque_nm=np.zeros((3, 2)))]
    assert effect("command_latency").places(walker(), by_torque) == ("commands",)
    assert effect("speed_limit").places(walker(), by_torque) == ()
