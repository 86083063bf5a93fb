"""The sim (MuJoCo) world with effects that a diagnosis has found."""

from collections import deque
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from mujoco.batch import Batch

from diagnosis.effects.library import effect
from diagnosis.effects.variants import Variants
from diagnosis.plant.load import described_plant
from diagnosis.plant.plant import Base, Plant
from diagnosis.replay.laws import BatchLaws
from diagnosis.replay.replay import hermite
from diagnosis.residuals.predictor import Model
from groundwalk.arrays import FloatArray
from robots import Description
from terrain import Heightfield
from worlds import Observation, Truth, WorldOptions
from worlds.rollouts import Schedule
from worlds.sim.world import SimWorld, ground_name, world_spec


class _Delay:
    """Values that count later, by a time that may end between two physics steps.

    A negative delay, as that of a clock may be, is none: nothing is known beforehand.
    `values` has the two that count now in front, the older one first, of which it has
    the `share`.
    """

    def __init__(self, delay_s: float, step_s: float) -> None:
        steps, self.share = divmod(max(delay_s, 0.0) / step_s, 1)
        self.values: deque[Any] = deque(maxlen=int(steps) + 2)

    def begin(self, value: Any) -> None:
        """Start as if the value had always been this one."""
        self.values.extend([value] * (self.values.maxlen or 0))


class _LateReadings:
    """Positions and velocities (n, j) as encoders report them, each joint as late."""

    def __init__(self, late_s: FloatArray, step_s: float) -> None:
        """Prepare for delays (j,) of the joints."""
        steps = np.maximum(late_s, 0.0) / step_s
        self._back, self._step_s = steps.astype(int), step_s
        self._since = 1 - (steps - self._back)
        self._columns = np.arange(len(late_s))
        rows = int(self._back.max()) + 2
        self._values: deque[tuple[FloatArray, FloatArray]] = deque(maxlen=rows)

    def begin(self, now: tuple[FloatArray, FloatArray]) -> None:
        """Start as if the joints had always been where they are now."""
        self._values.extend([now] * (self._values.maxlen or 0))

    def append(self, now: tuple[FloatArray, FloatArray]) -> None:
        """Take positions and velocities (n, j) after one more step."""
        self._values.append(now)

    def read(self) -> tuple[FloatArray, FloatArray]:
        """Positions and velocities (n, j) that are reported now."""
        last = len(self._values) - 1 - self._back
        every = [np.stack(one) for one in zip(*self._values, strict=True)]
        ends = [
            [one[at, :, self._columns].T for one in every] for at in (last - 1, last)
        ]
        return hermite(ends[0], ends[1], self._step_s, self._since)


def sim_plant(
    description: Description, options: WorldOptions, grounds: Sequence[Heightfield] = ()
) -> Plant:
    """Make the robot model that the sim world simulates, for use by a diagnosis.

    All `grounds` are put into the model, a plane if there are none. A fixed base has no
    ground.
    """
    base: Base = "fixed" if options.fixed_base else "floating"
    spec = world_spec(description, options, () if options.fixed_base else grounds)
    return described_plant(description, spec, base)


def sim_variants(plant: Plant, model: Model, n: int) -> Variants:
    """Make n equal copies of a robot model with the effects, for rollouts.

    A slope rotates gravity instead of the ground, so that heightfields stay in place.

    Raises:
      BadModelError: a sim cannot have one of the effects.
    """
    variants = Variants(plant, n)
    for placed in model:
        values = np.array(placed.values)
        for row in range(n):
            effect(placed.name).apply_to_sim(variants, row, placed.place, values)
    return variants


class CorrectedSim(SimWorld):
    """The sim world with effects that a diagnosis found, the same for all robots.

    Without effects it computes exactly the same as `SimWorld`. Effects that depend on
    time, such as pushes, count it from the start of the rollout.
    """

    def __init__(
        self,
        description: Description,
        grounds: Sequence[Heightfield],
        seeds: Sequence[np.random.SeedSequence],
        options: WorldOptions,
        model: Model,
    ) -> None:
        """Make the world with the effects of `model`; arguments as for `SimWorld`.

        A latency among the effects is added to that of the options.

        Raises:
          BadModelError: a sim cannot have one of the effects.
        """
        self._model = model
        self._laws: BatchLaws | None = None
        super().__init__(description, grounds, seeds, options)

    def _made_batch(self) -> Batch:
        """Make the batch of simulations, in which each robot touches its own ground."""
        if not self._model:
            return super()._made_batch()
        step_s = self.options.timestep_s
        grounds = list({id(ground): ground for ground in self._grounds}.values())
        plant = sim_plant(self.description, self.options, grounds)
        batch = Batch(plant.model, self.n, self.options.threads)
        if not self.options.fixed_base:
            touches = batch.expand("geom_conaffinity")
            for number, ground in enumerate(grounds):
                geom = plant.model.geom(ground_name(number)).id
                touches[:, geom] = [own is ground for own in self._grounds]
        variants = sim_variants(plant, self._model, self.n)
        self._laws = BatchLaws(batch, variants, [plant.servo], step_s)
        signals = variants.signals
        self._commands = _Delay(float(signals.command_delay_s[0]), step_s)
        self._encoders = _LateReadings(variants.late_s[0], step_s)
        self._gyro_bias_rad_s = signals.gyro_bias_rad_s
        return batch

    def _start(self, pose_rad: FloatArray) -> None:
        super()._start(pose_rad)
        if self._laws is not None:
            self._steps = 0
            self._laws.begin(pose_rad)
            self._commands.begin(pose_rad)
            self._encoders.begin(self._measured(self._laws))

    def _advance(self, schedule: Schedule) -> None:
        if self._laws is None:
            super()._advance(schedule)
            return
        for targets, steps in schedule:
            for _ in range(steps):
                now_s = np.array([self._steps * self.options.timestep_s])
                self._commands.values.append(targets)
                share, (older, newer, *_) = self._commands.share, self._commands.values
                self._laws.servo((1 - share) * newer + share * older, now_s)
                self._laws.outside.apply(now_s)
                self._run(1)
                self._steps += 1
                self._encoders.append(self._measured(self._laws))

    @staticmethod
    def _measured(laws: BatchLaws) -> tuple[FloatArray, FloatArray]:
        """Positions and velocities (n, j) that encoders without delay would report."""
        return laws.encoder_rad().copy(), laws.encoder_rad_s().copy()

    def _read(self) -> tuple[Truth, Observation]:
        """Read truth and observation; sensor effects act on the observation only."""
        truth, observation = super()._read()
        if self._laws is None:
            return truth, observation
        position, velocity = self._encoders.read()
        return truth, replace(
            observation,
            position_rad=position + self._laws.joints["offset_rad"],
            velocity_rad_s=velocity,
            gyroscope_rad_s=observation.gyroscope_rad_s + self._gyro_bias_rad_s,
        )
