"""What all tests share: patience, the NAO, and kinematics from another library."""

import gc

import numpy as np
import pytest
from copied_processes import copy_instead
from hypothesis import settings
from scipy.spatial.transform import Rotation

import robots

# No test may fail because the machine is busy.
settings.register_profile("no_deadline", deadline=None)
settings.load_profile("no_deadline")


def pytest_collection_modifyitems(items):
    """The longest begin first, so that no worker is left alone with one at the end."""
    items.sort(key=lambda item: ("journeys" not in item.path.parts, not slow(item)))


def pytest_collection_finish():
    """Thousands of tests are searched for garbage no more, which would take a while."""
    gc.collect()
    gc.freeze()


def slow(item):
    """Whether a test takes more than a few seconds."""
    return item.get_closest_marker("slow") is not None


@pytest.fixture(scope="session", autouse=True)
def quick_processes():
    """See `copied_processes`."""
    with pytest.MonkeyPatch.context() as patch:
        copy_instead(patch)
        yield


def chain(description, pose_rad):
    """Rotations (n, 3, 3) and places (n, 3) of each joint's frame, in the torso frame.

    Walks down the chain with SciPy's rotations; `pose_rad` is (n, joints).
    """
    turns, places = [], []
    for k, joint in enumerate(description.links):
        turn = Rotation.from_rotvec(np.outer(pose_rad[:, k], joint.axis))
        if joint.parent < 0:
            places.append(np.tile(joint.origin_m, (len(pose_rad), 1)))
        else:
            above = turns[joint.parent]
            places.append(places[joint.parent] + above.apply(joint.origin_m))
            turn = above * turn
        turns.append(turn)
    return [turn.as_matrix() for turn in turns], places


@pytest.fixture(scope="session")
def nao():
    return robots.get("nao")


@pytest.fixture(scope="session")
def link_frames():
    """The function `chain`."""
    return chain


@pytest.fixture(scope="session")
def crouch(nao):
    """(joints,) the walk's crouch, hip height 0.23 m: facts from the Walk2014 source.

    Arms hang; the elbows stay inside of their range.
    """
    angles = {
        "HipPitch": -0.3746,
        "KneePitch": 0.8446,
        "AnklePitch": -0.4699,
        "ShoulderPitch": np.pi / 2,
    }
    pose = np.array([angles.get(name[1:], 0.0) for name in nao.joints])
    pose[nao.joints.index("LElbowRoll")] = -0.05
    pose[nao.joints.index("RElbowRoll")] = 0.05
    return pose


@pytest.fixture(scope="session")
def random_poses(nao):
    """Function: n poses (n, joints), evenly within the joints' ranges."""

    def draw(n, seed):
        low, high = nao.joint_range_rad.T
        return np.random.default_rng(seed).uniform(low, high, (n, len(low)))

    return draw
