"""Two joints of one motor, in Bullet."""

from typing import Any

TORQUE_NM, ERP = 1e3, 0.2
"""Stiff enough that the joints stay together, soft enough for Bullet's solver."""


def couple(
    bullet: Any, client: dict[str, int], body: int, first: int, second: int
) -> None:
    """Hold two joints at the same angle with a gear.

    Args:
      bullet: the module pybullet.
      client: `{"physicsClientId": number}`.
      body: Bullet's number of the robot.
      first: Bullet's number of one joint.
      second: of the other one.
    """
    gear = bullet.createConstraint(
        parentBodyUniqueId=body,
        parentLinkIndex=first,
        childBodyUniqueId=body,
        childLinkIndex=second,
        jointType=bullet.JOINT_GEAR,
        jointAxis=[0, 1, 0],
        parentFramePosition=[0] * 3,
        childFramePosition=[0] * 3,
        **client,
    )
    bullet.changeConstraint(gear, gearRatio=-1, maxForce=TORQUE_NM, erp=ERP, **client)
