"""Measures of what limits a robot in a gait: joint ranges, motors, size of soles."""

from typing import Any

import numpy as np

import robots
from groundwalk.arrays import FloatArray
from robots import Biped, Description, biped
from walk_engine import Gait
from walk_engine.legs import Legs
from worlds import Recording
from worlds.scenes.scene import LinkPoses, link_poses

FEET_PARTS = (-1.0, 0.0, 1.0)
"""Positions of the feet, relative to the hips, at which `reach` is measured: behind,
below and ahead, in units of a quarter of the distance walked in one gait cycle."""


def sole(description: Description) -> dict[str, float]:
    """Length and width of a sole, relative to the NAO's scaled to the robot's size."""
    of_nao, own = (
        np.ptp(robot.feet[0].outline_m, axis=0) / robot.scale.length
        for robot in (robots.get("nao"), description)
    )
    return dict(zip(("length", "width"), (own / of_nao).tolist(), strict=True))


def reach(description: Description, gait: Gait) -> dict[str, Any]:
    """Measure how far the joint ranges keep a gait's feet from their targets.

    The targets are behind, below and ahead of the hips, on the ground and lifted. The
    walk engine's inverse kinematics gives the joint angles, which are clipped to the
    ranges; forward kinematics then gives the poses of the feet. The gait is in the
    NAO's size, and scaled to the robot.

    Returns:
      `place_m`, largest distance of an ankle from its target [m]; `tilt_rad`, largest
      tilt of a sole, which should be level [rad]; `joint`, the leg joint whose target
      is farthest outside its range, "" if none is.
    """
    body = biped(description)
    ankle_m = _targets_m(body, gait)
    angles = _angles(body, ankle_m)
    low, high = body.joint_range_rad.T
    beyond = np.maximum(low - angles, angles - high)
    legs = [*body.left_leg, *body.right_leg]
    worst = legs[int(beyond.max(axis=0)[legs].argmax())]
    wanted = _poses(description, angles)
    reached = _poses(description, np.clip(angles, low, high))
    places, tilts = [], []
    for foot in description.feet:
        name = description.links[foot.joint].link.name
        away = reached[name].position_m - wanted[name].position_m
        places.append(np.linalg.norm(away, axis=1).max())
        _, x, y, _ = reached[name].orientation.T
        tilts.append(2 * np.arcsin(np.clip(np.hypot(x, y), 0, 1)).max())
    joint = description.joints[worst] if beyond[:, worst].max() > 0 else ""
    return {
        "place_m": float(max(places)),
        "tilt_rad": float(max(tilts)),
        "joint": joint,
    }


def saturation(description: Description, recording: Recording) -> dict[str, Any]:
    """The motor that is at its limit for the largest share of a walk, and this share.

    Its torque is computed from the commands, positions and velocities in the recording.
    The `joint` is "" if no motor is ever at its limit.
    """
    shares = {}
    for joint in description.links:
        motor, column = joint.motor, recording.columns
        error = column[f"command.{joint.name}"] - column[f"position.{joint.name}"]
        drive = motor.drive_nm(error, column[f"velocity.{joint.name}"])
        shares[joint.name] = float(np.mean(np.abs(drive) >= motor.stall_torque_nm))
    worst = max(shares, key=lambda name: shares[name])
    return {"share": shares[worst], "joint": worst if shares[worst] else ""}


def _targets_m(body: Biped, gait: Gait) -> FloatArray:
    """(3, 2, n) xyz targets of both ankles in the torso's frame [m]; right mirrored."""
    scale, leg = body.scale, body.leg
    quarter_m = gait["max_forward"] * gait["step_period"] / 2 * scale.length
    ahead = quarter_m * np.array(FEET_PARTS)
    below = gait["hip_height"] * scale.length - leg.ankle_height_m
    lifts = np.array([0.0, gait["base_leg_lift"] * scale.length])
    x, z = (part.ravel() for part in np.meshgrid(ahead, below - lifts))
    x = x + leg.hip_m[0] + body.ankles_ahead_m - gait["com_offset"] * scale.length
    one = np.stack([x, np.full_like(x, leg.hip_m[1]), leg.hip_m[2] - z])
    return np.stack([one, one], axis=1)


def _angles(body: Biped, ankle_m: FloatArray) -> FloatArray:
    """(n, joints) angles [rad] for ankles (3, 2, n) [m] and level soles, unclipped."""
    n = ankle_m.shape[2]
    none = np.zeros((2, n))
    left, right = Legs(body).angles(ankle_m, none, none, np.zeros((2, 2, n)))
    angles = np.zeros((n, body.joints))
    angles[:, list(body.left_leg)] = left.T
    angles[:, list(body.right_leg)] = right.T
    return angles


def _poses(description: Description, angles_rad: FloatArray) -> dict[str, LinkPoses]:
    n = len(angles_rad)
    base = LinkPoses(np.zeros((n, 3)), np.tile([1.0, 0.0, 0.0, 0.0], (n, 1)))
    return link_poses(description, angles_rad, base)
