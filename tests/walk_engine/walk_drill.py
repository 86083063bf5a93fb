"""Drives a walk engine without physics: the weight swings by the clock."""

import numpy as np
from leg_fk import forward

from walk_engine import Velocity
from walk_engine.legs import MIRROR

LEFT, RIGHT = 1, -1


def forces(side, n=1, newton=24.0):
    """(n, 8) with all the weight on one foot, or shared for side 0."""
    on_left = (1 + side) / 2
    feet = np.repeat([on_left, 1 - on_left], 4) * newton / 4
    return np.tile(feet, (n, 1))


class Drill:
    """An engine and a clock that moves the weight to the other foot once a period.

    The weight lies on the foot opposite to the first swing foot first.
    """

    def __init__(self, engine, half_period_s=0.23, first_side=RIGHT):
        self.engine = engine
        self.half_ticks = round(half_period_s / 0.01)
        self.side = first_side
        self.tick = 0
        self.commands, self.supports, self.states, self.times = [], [], [], []

    def run(self, ticks, request=None, gyroscope=None):
        """Some ticks of walking; returns the commands of these, (ticks, n, joints)."""
        request = Velocity.forward() if request is None else request
        n = self.engine.n
        rates = np.zeros((n, 3)) if gyroscope is None else gyroscope
        for _ in range(ticks):
            if self.tick and self.tick % self.half_ticks == 0:
                self.side = -self.side
            self.commands.append(self.engine.step(request, rates, forces(self.side, n)))
            self.tick += 1
            self.supports.append(self.engine.support)
            self.states.append(self.engine.state)
            self.times.append(self.engine.step_time_s)
        return np.array(self.commands[-ticks:])


def feet_of(biped, command):
    """Ankles (..., 2, 3) and foot rotations (..., 2, 3, 3) of commands (..., joints).

    In the torso frame, the left foot first.
    """
    flip = np.diag([1.0, -1.0, 1.0])
    angles = np.moveaxis(command, -1, 0)
    left, turn_left = forward(biped.leg, angles[list(biped.left_leg)])
    mirrored = angles[list(biped.right_leg)] * np.reshape(
        MIRROR, (6,) + (1,) * (angles.ndim - 1)
    )
    right, turn_right = forward(biped.leg, mirrored)
    ankles = np.stack([np.moveaxis(left, 0, -1), np.moveaxis(right, 0, -1) @ flip], -2)
    turns = np.stack(
        [
            np.moveaxis(turn_left, (0, 1), (-2, -1)),
            flip @ np.moveaxis(turn_right, (0, 1), (-2, -1)) @ flip,
        ],
        -3,
    )
    return ankles, turns
