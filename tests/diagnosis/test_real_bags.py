"""Real arms with unknown controllers, if their bags are at hand.

Friction of the UR10: Petrone, Ferrentino and Chiacchio, IEEE T-II 2025; of the Panda:
Gaz, Cognetti et al., RA-L 2019.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from diagnosis.pipeline import diagnose
from diagnosis.plant.load import load_plant
from diagnosis.traces.read import trace_of
from worlds import RecordingMetadata
from worlds.foreign import read_bag

BAGS = Path(__file__).parents[2] / ".." / "shared" / "data" / "bags"
UR10_COULOMB_NM = 13.9, 17.2, 9.4, 2.6, 2.8, 3.5
UR10_VISCOUS = 14.5, 14.2, 7.7, 3.6, 2.6, 2.8
PANDA_COULOMB_NM = 0.27, 0.44, 0.32, 0.64, 0.42, 0.15, 0.28
PANDA_HAND_KG = 0.73 + 2 * 0.015
"""Hand and fingers of the URDF, which are fixed to its last link."""

at_hand = pytest.mark.skipif(
    not BAGS.is_dir(), reason="no real recordings in ../shared/data"
)


def trace_of_bag(path, plant, new_names=None):
    """Positions and efforts of a bag, in the order of the plant's joints."""
    found = read_bag(path).renamed(new_names or {})
    metadata = RecordingMetadata(plant.name, plant.base, found.source)
    trace = trace_of(found.recording(metadata), plant, path.stem)
    return replace(trace, velocity_rad_s=None)


def diagnosed(plant, trace):
    """Verdict, and values with intervals by effect and place."""
    verdict = diagnose(plant, [trace], np.random.SeedSequence(1)).verdict
    found = {
        (one.name, one.place): next(iter(one.parameters.values()))
        for one in verdict.effects
    }
    return verdict, found


def near(found, name, joints, published, factor):
    """Number of joints at which a value is within a factor of the published one."""
    count = 0
    for joint, true in zip(joints, published, strict=True):
        if (name, joint) in found:
            count += 1 / factor < found[name, joint].value / true < factor
    return count


@at_hand
@pytest.mark.slow
def test_friction_of_a_ur10():
    plant = load_plant("ur10_robot", "fixed")
    trace = trace_of_bag(BAGS / "ur10_exciting.db3", plant)
    verdict, found = diagnosed(plant, trace)
    assert verdict.kind == "effects"
    assert near(found, "coulomb_friction", plant.joints, UR10_COULOMB_NM, 1.5) == 6
    assert near(found, "viscous_friction", plant.joints, UR10_VISCOUS, 1.5) == 6
    # one rotor that the URDF lacks turns 100 times as fast as its joint
    rotors = [found[key].value for key in found if key[0] == "armature"]
    assert all(inertia < 3.0 for inertia in rotors)
    assert verdict.fit.corrected < 0.25 * verdict.fit.nominal


@at_hand
@pytest.mark.slow
def test_friction_of_a_panda():
    plant = load_plant("panda", "fixed", [f"panda_joint{k}" for k in range(1, 8)])
    path = BAGS / "panda_exciting.db3"
    trace = trace_of_bag(path, plant, {"fer_*": "panda_*"})
    verdict, found = diagnosed(plant, trace)
    assert near(found, "coulomb_friction", plant.joints, PANDA_COULOMB_NM, 2.0) == 6
    # the arm seems to have moved without the hand that its model holds
    mass = found["payload_mass", "panda_link7"]
    assert mass.value == pytest.approx(-PANDA_HAND_KG, rel=0.25)
    # what else is said holds in motions that were kept out
    assert verdict.fit.corrected < 0.25 * verdict.fit.nominal
    assert not any("worse" in text for text in verdict.limits)
