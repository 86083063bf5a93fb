"""Effects between feet and ground: a box of known weight against closed forms."""

import mujoco
import numpy as np
import pytest
from mujoco.batch import Batch

from diagnosis.effects.library import effect
from diagnosis.effects.variants import Variants
from diagnosis.plant.plant import Plant
from diagnosis.plant.servo import Servo

WEIGHT_N = 3.0 * 9.81
BLOCK = """
<mujoco><option timestep=".001" {option}/><asset>
    <mesh name="brick" vertex="-.1 -.1 -.05 .1 -.1 -.05 -.1 .1 -.05 .1 .1 -.05
      -.1 -.1 .05 .1 -.1 .05 -.1 .1 .05 .1 .1 .05"/></asset>
  <worldbody>
  <geom name="ground" type="plane" size="1 1 1" friction=".6 .005 .0001" {ground}/>
  <body name="foot"><freejoint name="root"/>{shape}
    <body name="weight"><joint name="hinge" axis="0 1 0" stiffness="100" damping="5"/>
      <geom size=".02" mass="1" contype="0" conaffinity="0"/></body>
  </body></worldbody>
  <actuator><general name="hinge" joint="hinge"/></actuator></mujoco>"""
BOX = '<geom type="box" size=".1 .1 .05" mass="2" friction=".4 .005 .0001"/>'
CORNERS = "".join(
    f'<geom size=".01" pos="{x} {y} -.04" mass=".5"/>'
    for x in (-0.1, 0.1)
    for y in (-0.1, 0.1)
)
CYLINDER = '<geom type="cylinder" size=".1 .05" mass="2"/>'
MESH = '<geom type="mesh" mesh="brick" mass="2"/>'
HEIGHT_M = 0.05


def block(shape=BOX, option="", ground=""):
    xml = BLOCK.format(shape=shape, option=option, ground=ground)
    servo = Servo(*(np.array([value]) for value in (20.0, 0.5, 3.0, 0.0)))
    spec = mujoco.MjSpec.from_string(xml)
    return Plant("block", spec, ("hinge",), servo, base="floating", feet=("foot",))


def changed(plant, *effects):
    """Row 0 as it is, row 1 with effects (name, *values)."""
    variants = Variants(plant, 2)
    for name, *values in effects:
        place = "world" if name == "ground_slope" else "feet"
        effect(name).apply(variants, 1, place, np.array(values, float))
    return variants


def started(variants):
    """A batch that stands on the ground, with the variants' fields."""
    batch = Batch(variants.plant.model, variants.n, nthread=1)
    for name, values in variants.fields.items():
        field = batch.expand(name)
        field[...] = values.reshape(field.shape)
    batch.set_const()
    batch.reset()
    batch.bind("qpos")[:, 2] = HEIGHT_M
    return batch


def sunk_m(variants, steps=6000):
    """How deep each row's foot is in the ground at rest."""
    batch = started(variants)
    batch.step(nstep=steps)
    assert np.abs(batch.bind("qvel")).max() < 1e-3
    return HEIGHT_M - batch.bind("qpos")[:, 2]


# Compliance


@pytest.mark.parametrize("shape", [BOX, CORNERS, CYLINDER, MESH])
@pytest.mark.parametrize("option", ['cone="elliptic"', 'cone="pyramidal"'])
def test_a_block_sinks_by_its_weight_over_stiffness(shape, option):
    stiffness = 4e3
    variants = changed(block(shape, option), ("contact_compliance", stiffness))
    hard, soft = sunk_m(variants)
    assert soft == pytest.approx(WEIGHT_N / stiffness, rel=0.01)
    assert hard < 1e-3


def test_compliances_add():
    effects = [("contact_compliance", 4e3), ("contact_compliance", 6e3)]
    _, soft = sunk_m(changed(block(), *effects))
    assert soft == pytest.approx(WEIGHT_N / 4e3 + WEIGHT_N / 6e3, rel=0.01)


def test_a_block_bounces_as_a_damped_spring():
    stiffness, mass = 4e3, 3.0
    batch = started(changed(block(), ("contact_compliance", stiffness)))
    height = batch.bind("qpos")
    depths = []
    for _ in range(600):
        batch.step()
        depths.append(HEIGHT_M - height[1, 2])
    rest = WEIGHT_N / stiffness
    overshoot = max(depths) / rest - 1
    # The foot's own mass weighs a quarter more in contact (see the effect): of 3 kg
    # at most 0.25 / body_invweight0, about 0.6 kg.
    for_mass = [
        np.exp(-np.pi * z / np.sqrt(1 - z**2))
        for z in (0.1, 0.1 / np.sqrt(1 + 0.6 / mass))
    ]
    assert for_mass[0] - 0.1 < overshoot < for_mass[1] + 0.1
    half_period_s = np.argmax(depths) * 1e-3
    quickest = np.pi * np.sqrt(mass / stiffness)
    assert 0.98 * quickest < half_period_s < 1.15 * quickest


def test_a_soft_foot_hardly_creeps():
    pull, stiffness, mass = 2.0, 4e3, 3.0
    plant = block(BOX, f'gravity="{pull} 0 -9.81"')
    batch = started(changed(plant, ("contact_compliance", stiffness)))
    batch.step(nstep=1000)
    before = batch.bind("qpos")[1, 0]
    batch.step(nstep=1000)
    damping = 2 * 0.1 * np.sqrt(stiffness * mass)
    crept = batch.bind("qpos")[1, 0] - before
    assert crept == pytest.approx(pull * mass / (100 * damping), rel=0.02)


# Friction


def slides(variants):
    """Whether rows move faster than creep after a second."""
    batch = started(variants)
    batch.step(nstep=1000)
    return (batch.bind("qvel")[:, 0] > 0.1).tolist()


@pytest.mark.parametrize("ground", ["", 'priority="1"', 'priority="-1"'])
def test_a_block_slides_beyond_the_friction_cone(ground):
    nominal = 0.4 if "-1" in ground else 0.6
    pull = 9.81 * 0.35
    plant = block(BOX, f'gravity="{pull} 0 -9.81" cone="elliptic"', ground)
    (parameter,) = effect("contact_friction").parameters(plant, "feet")
    assert parameter.neutral == nominal
    assert slides(changed(plant, ("contact_friction", 0.32))) == [False, True]
    assert slides(changed(plant, ("contact_friction", 0.38))) == [False, False]


def test_friction_slows_as_coulomb_said():
    plant = block(BOX, 'gravity="4 0 -9.81" cone="elliptic"')
    batch = started(
        changed(plant, ("contact_friction", 0.3), ("contact_friction", 0.3))
    )
    batch.step(nstep=1000)
    # Twice 0.3 instead of 0.6: 0.15.
    speed = batch.bind("qvel")[1, 0]
    assert speed == pytest.approx(4 - 0.15 * 9.81, rel=0.02)


def test_friction_is_sliding_friction_only():
    friction = changed(block(), ("contact_friction", 0.3)).fields["geom_friction"]
    np.testing.assert_array_equal(friction[0, :, 1:], friction[1, :, 1:])
    np.testing.assert_allclose(friction[1, :, 0], [0.3, 0.2, 1.0])


# Slope


@pytest.mark.parametrize(
    ("pitch", "roll", "uphill"), [(0.1, 0, (-1, 0)), (0, 0.1, (0, 1))]
)
def test_the_ground_tilts(pitch, roll, uphill):
    variants = changed(block(CORNERS), ("ground_slope", pitch, roll))
    batch = started(variants)
    point = 0.5 * np.array(uphill)
    heights = []
    for row in range(2):
        distance, *_ = batch.ray([*point, 1.0], [0, 0, -1.0], ids=[row])
        heights.append(1.0 - float(np.ravel(distance)[0]))
    assert heights[0] == pytest.approx(0.0, abs=1e-9)
    assert heights[1] == pytest.approx(0.5 * np.tan(0.1), abs=1e-9)


def test_raised_ground_turns_about_the_origin():
    plant = block(BOX, ground='pos="0 0 .2"')
    variants = changed(plant, ("ground_slope", 0.1, 0.0))
    ground = plant.model.geom("ground").id
    np.testing.assert_allclose(
        variants.fields["geom_pos"][1, ground],
        [0.2 * np.sin(0.1), 0, 0.2 * np.cos(0.1)],
        atol=1e-12,
    )


def test_only_the_ground_tilts():
    variants = changed(block(), ("ground_slope", 0.1, 0.0))
    foot = 1
    assert (variants.fields["geom_quat"][1, foot] == [1, 0, 0, 0]).all()
    assert "opt.gravity" not in variants.fields
