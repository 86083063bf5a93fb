"""Real arms with unknown controllers, if their bags are at hand.

Friction of the UR10: Petrone, Ferrentino and Chiacchio, IEEE T-II 2025; of the Panda:
Gaz, Cognetti et al., RA-L 2019.
"""

from pathlib import Path

import numpy as np
import pytest
from ros_bags import joint_state, trace_of_bag

from diagnosis.pipeline import diagnose
from diagnosis.plant.load import load_plant

BAGS = Path(__file__).parents[2] / ".." / "shared" / "data" / "bags"
UR10_COULOMB_NM = 13.9, 17.2, 9.4, 2.6, 2.8, 3.5
UR10_VISCOUS = 14.5, 14.2, 7.7, 3.6, 2.6, 2.8
PANDA_COULOMB_NM = 0.27, 0.44, 0.32, 0.64, 0.42, 0.15, 0.28

at_hand = pytest.mark.skipif(
    not BAGS.is_dir(), reason="no real recordings in ../shared/data"
)


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
    trace = trace_of_bag(path, plant, lambda name: name.replace("fer_", "panda_"))
    verdict, found = diagnosed(plant, trace)
    assert near(found, "coulomb_friction", plant.joints, PANDA_COULOMB_NM, 2.0) >= 5
    # what else is said holds in motions that were kept out
    assert verdict.fit.corrected < 0.25 * verdict.fit.nominal
    assert not any("worse" in text for text in verdict.limits)


def test_a_message_is_read():
    """One message, its bytes put together by hand after the standard (XCDR 1)."""
    texts = b"\x04\x00\x00\x00hip\x00\x05\x00\x00\x00knee\x00"
    content = (
        b"\x00\x01\x00\x00"  # little-endian
        + b"\x01\x00\x00\x00\x02\x00\x00\x00"  # stamp
        + b"\x02\x00\x00\x00a\x00"  # frame, ends at byte 14 of the payload
        + b"\x00\x00\x02\x00\x00\x00"  # aligned to 4; two names
        + texts  # ends at byte 37
        + b"\x00\x00\x00\x02\x00\x00\x00"  # aligned to 4: 40; two positions
        + b"\x00\x00\x00\x00"  # aligned to 8: 48
        + np.array([1.5, -2.0]).tobytes()
        + b"\x00\x00\x00\x00"  # no velocities
        + b"\x01\x00\x00\x00"  # one effort, at byte 72
        + np.array([0.25]).tobytes()
    )
    names, position, velocity, effort = joint_state(content)
    assert names == ["hip", "knee"]
    assert position.tolist() == [1.5, -2.0]
    assert velocity.tolist() == []
    assert effort.tolist() == [0.25]
