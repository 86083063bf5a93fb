"""A robot with hidden physics as it goes on, a fine step at a time."""

from collections import deque
from collections.abc import Sequence
from math import ceil

import numpy as np

from groundwalk.arrays import FloatArray
from worlds.hidden.clock import CommandLine
from worlds.hidden.effects import Hidden
from worlds.hidden.engine import WATCH_STEPS, HiddenEngine, least_inertia_kg_m2
from worlds.hidden.joints import HiddenJoints
from worlds.hidden.plant import HiddenPlant


class HiddenDrive:
    """Commands and pushes on their way to a robot, and encoders on theirs from it."""

    def __init__(
        self,
        plant: HiddenPlant,
        effects: Sequence[Hidden],
        world: HiddenEngine,
        step_s: float,
        start_rad: FloatArray,
    ) -> None:
        """Begin where the robot rests.

        Args:
          plant: the nominal robot.
          effects: what is hidden.
          world: that has been reset to the pose.
          step_s: fine step.
          start_rad: (j,) the pose.

        Raises:
          GroundwalkError: a place is unknown.
        """
        inertia = least_inertia_kg_m2(plant, [start_rad])
        self._world, self._step_s, self._effects = world, step_s, effects
        self._joints = HiddenJoints(plant, effects, step_s, inertia)
        self._line = CommandLine(start_rad, self._delay_steps("command_latency"))
        self._forces = [e for e in effects if e.name in ("external_force", "drag")]
        self._late_steps = self._delay_steps("sensor_delay")
        self._step = 0
        # Where the encoders have been, as far back as they are late.
        self._seen = deque([start_rad], maxlen=ceil(self._late_steps) + 2)

    def _delay_steps(self, name: str) -> float:
        delay_s = sum(e["delay"] for e in self._effects if e.name == name)
        return delay_s / self._step_s

    def send(self, command_rad: FloatArray) -> None:
        """Send (j,) position targets."""
        self._line.send(self._step, command_rad)

    def advance(self, steps: int, zero_step: int = 0) -> None:
        """Go on; the engine watches over the last steps.

        Args:
          steps: how many fine ones.
          zero_step: number of the step at which the effects' time is 0.
        """
        world, end = self._world, self._step + steps
        while self._step < end:
            time_s = (self._step - zero_step) * self._step_s
            self._push(time_s)
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

    def _push(self, time_s: float) -> None:
        for effect in self._forces:
            if effect.name == "drag":
                speed = self._world.body_velocity(effect.place)
                self._world.push(effect.place, -effect["coefficient"] * speed)
            elif 0 <= time_s - effect["start"] < effect["duration"]:
                force_n = np.array([effect["x"], effect["y"], effect["z"]])
                self._world.push(effect.place, force_n)

    def encoders(self) -> FloatArray:
        """(j,) what perfect encoders say now, offsets and delays included."""
        steps = np.arange(self._step + 1 - len(self._seen), self._step + 1)
        late = self._step - self._late_steps
        angles = [np.interp(late, steps, column) for column in np.transpose(self._seen)]
        return np.array(angles) + self._joints.offset_rad
