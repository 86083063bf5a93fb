"""Where an effect may be hidden, such that it can be told from all others.

An effect that acts exactly as another one does, or that does nothing, has no place:

- a fixed base's late encoders act as late commands: no `sensor_delay`;
- a joint that gravity does not load turns as it did with an `encoder_offset`, and a
  body whose weight no moving joint feels does with a `payload_mass` or `com_offset`;
- on a body that one joint moves, `drag` is that joint's viscous friction;
- where nothing moves there is neither `drag` nor an `external_force` to be seen;
- a joint that never needs its servo's torque does not show a `torque_limit`;
- a tilted mount is an encoder's offset where there is but one joint: no `ground_slope`.

A floating base's ground carries whatever does not move, so there a payload has to be
on something that does.
"""

from collections.abc import Sequence
from typing import NamedTuple

from worlds.hidden.effects import KINDS
from worlds.hidden.plant import HiddenPlant
from worlds.hidden.scales import Scales

ON_FEET = ("contact_friction", "contact_compliance", "uneven_ground", "sensor_delay")
"""Effects that need a floating base."""
LEAST_MOTION_RAD = 0.08
"""Of a joint's commands, if it counts as one that moves."""
LEAST_MOVED_M = 0.03
"""Of a centre of mass, if the body counts as one that moves."""
LEAST_LEVER_M = 0.02
"""Of a weight at a joint, if it counts as loaded."""
_LEAST_EFFORT = 0.06
"""Of the servo's most torque, if a joint counts as one that needs it."""
_MANY_JOINTS = ("ground_slope", "joint_crosstalk")


class Spot(NamedTuple):
    """A joint's column, and its link or the trunk."""

    joint: int
    body: str


def spots(
    name: str, plant: HiddenPlant, scales: Scales, joints: Sequence[int]
) -> list[Spot]:
    """Where an effect may be; nowhere if this robot cannot tell it from another.

    Args:
      name: of the effect.
      plant: the robot.
      scales: what it does with nothing hidden.
      joints: that may be chosen.
    """
    if not _possible(name, plant):
        return []
    found = [Spot(joint, plant.links[joint]) for joint in joints]
    if KINDS[name].place == "body":
        if plant.floating and plant.description is not None:
            trunk = plant.description.root.name
            found += [Spot(joint, trunk) for joint in joints]
        return [spot for spot in found if _body_tells(name, plant, scales, spot.body)]
    if name == "encoder_offset" and not plant.floating:
        lever_m = scales.bodies.branch_lever_m
        return [spot for spot in found if lever_m[spot.joint] >= LEAST_LEVER_M]
    if name == "torque_limit":
        effort = scales.peak_nm / plant.max_torque_nm
        return [spot for spot in found if effort[spot.joint] >= _LEAST_EFFORT]
    return found


def moved_by_many(plant: HiddenPlant, scales: Scales, body: str) -> bool:
    """Whether at least two joints that move, or a free base, move a body."""
    row = scales.bodies.names.index(body)
    moving = scales.asked_rad > LEAST_MOTION_RAD
    return plant.floating or int(scales.bodies.carried_by[row, moving].sum()) > 1


def _possible(name: str, plant: HiddenPlant) -> bool:
    if name in ON_FEET:
        return plant.floating
    if name in _MANY_JOINTS:
        return len(plant.joints) > 1
    return name != "gyro_bias" or plant.description is not None


def _body_tells(name: str, plant: HiddenPlant, scales: Scales, body: str) -> bool:
    row = scales.bodies.names.index(body)
    moves = bool(scales.bodies.moved_m[row] >= LEAST_MOVED_M)
    if name == "drag":
        return moves and moved_by_many(plant, scales, body)
    if name == "external_force" or plant.floating:
        return moves
    moving = scales.asked_rad > LEAST_MOTION_RAD
    levers_m = scales.bodies.lever_m[row, moving]
    return bool(levers_m.max(initial=0.0) >= LEAST_LEVER_M)
