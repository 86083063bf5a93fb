"""Steps one robot with hidden physics in a physics engine."""

from collections import deque
from collections.abc import Sequence
from functools import partial
from math import ceil

import numpy as np

from groundwalk.arrays import FloatArray
from worlds.hidden.clock import CommandLine
from worlds.hidden.effects.placed import Hidden, surroundings
from worlds.hidden.engine import WATCH_STEPS, HiddenEngine, least_inertia_kg_m2
from worlds.hidden.joints import HiddenJoints
from worlds.hidden.plant import HiddenPlant


class HiddenDrive:
    """Applies commands, joint torques and pushes to a robot; reads its encoders."""

    def __init__(
        self,
        plant: HiddenPlant,
        effects: Sequence[Hidden],
        world: HiddenEngine,
        step_s: float,
        start_rad: FloatArray,
    ) -> None:
        """Begin with the robot at rest in the (j,) start pose of the engine `world`."""
        inertia = least_inertia_kg_m2(plant, start_rad)
        around = surroundings(effects)
        self._world, self._step_s = world, step_s
        self._joints = HiddenJoints(plant, effects, step_s, inertia)
        self._line = CommandLine(start_rad, around.command_delay_s / step_s)
        pushes = [(effect.place, effect.kind.push(effect.values)) for effect in effects]
        self._pushes = [(body, push) for body, push in pushes if push is not None]
        self._late_steps = around.encoder_delay_s / step_s
        self._step = 0
        # Past angles at the encoders, as many as their delay needs.
        self._seen = deque([start_rad], maxlen=ceil(self._late_steps) + 2)

    def send(self, command_rad: FloatArray) -> None:
        """Send (j,) position targets to the servos, which get them after the delay."""
        self._line.send(self._step, command_rad)

    def advance(self, steps: int, zero_step: int = 0) -> None:
        """Take physics steps; sensor values are averaged over the last of them.

        Effects count their time from the physics step number `zero_step`.
        """
        world, end = self._world, self._step + steps
        while self._step < end:
            time_s = (self._step - zero_step) * self._step_s
            for body, push in self._pushes:
                force_n = push(time_s, partial(world.body_velocity, body))
                if force_n is not None:
                    world.push(body, force_n)
            torque = self._joints.torque(
                time_s,
                world.position_rad,
                world.velocity_rad_s,
                self._line.over(self._step),
            )
            world.step(torque)
            self._step += 1
            self._seen.append(self._joints.encoders(world.position_rad).copy())
            if self._step > end - WATCH_STEPS:
                world.watch()

    def encoders(self) -> FloatArray:
        """(j,) readings [rad] of noiseless encoders now, with offsets and delays."""
        steps = np.arange(self._step + 1 - len(self._seen), self._step + 1)
        late = self._step - self._late_steps
        angles = [np.interp(late, steps, column) for column in np.transpose(self._seen)]
        return np.array(angles) + self._joints.offset_rad
