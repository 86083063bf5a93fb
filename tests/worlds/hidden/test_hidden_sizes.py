"""Sizes of hidden effects in concealed cases, from hard to easy to see."""

import numpy as np
import pytest

from worlds.hidden import KINDS, Hidden, Setting, Spot, hidden_plant
from worlds.hidden.setting import Scales

EASES = (-2.0, 0.0, 0.5, 1.0)  # as far as the sizing by information goes


def setting(ease, seed=0):
    """At the left knee of a NAO that swings by half a radian."""
    plant = hidden_plant("nao", floating=True)
    j, names = len(plant.joints), (*plant.links, "torso")
    scales = Scales(
        torque_nm=np.full(j, 1.0),
        peak_nm=np.full(j, 2.0),
        peak_rad_s=np.full(j, 3.0),
        reach_rad=np.tile([-0.25, 0.25], (j, 1)),
        asked_rad=np.full(j, 0.5),
        inertia_kg_m2=np.full(j, 0.01),
        carried_kg=np.full(j, 1.0),
        axis=np.tile([0.0, 1.0, 0.0], (j, 1)),
        moving_kg=5.0,
        bodies=names,
        moved_m=np.full(len(names), 0.1),
        carried_by=np.ones((len(names), j), bool),
        lever_m=np.full((len(names), j), 0.1),
        branch_lever_m=np.full(j, 0.1),
        arm_m=np.tile([0.0, 0.0, -0.1], (j, 1)),
    )
    joint = plant.joints.index("LKneePitch")
    spot = Spot(joint, plant.links[joint])
    return Setting(plant, scales, spot, ease, 5.0, np.random.default_rng(seed))


@pytest.mark.parametrize("name", KINDS)
def test_every_size_that_can_be_drawn_is_within_its_range(name):
    for ease in EASES:
        for seed in range(5):
            effect = Hidden.sized(name, setting(ease, seed))
            assert effect.name == name


@pytest.mark.parametrize(
    ("name", "parameter", "hard", "easy"),
    [
        ("backlash", "gap", 0.003, 0.06),
        ("contact_friction", "coefficient", 0.6, 0.2),
        ("coulomb_friction", "torque", 0.01, 0.15),
        ("speed_limit", "speed", 0.9 * 3.0, 0.4 * 3.0),
        ("torque_limit", "torque", 0.9 * 2.0, 0.4 * 2.0),
    ],
)
def test_sizes_go_from_hard_to_easy(name, parameter, hard, easy):
    sizes = [Hidden.sized(name, setting(ease))[parameter] for ease in (0.0, 1.0)]
    assert sizes == pytest.approx([hard, easy])


def test_kinds_that_cancel_each_other_say_so_of_each_other():
    for kind in KINDS.values():
        for other in kind.apart:
            assert kind.name in KINDS[other].apart
