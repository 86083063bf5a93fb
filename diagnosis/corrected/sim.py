"""The sim (MuJoCo) world with effects that a diagnosis has found."""

from collections import deque
from collections.abc import Sequence
from dataclasses import replace

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


class LateCommands:
    """Delays commands; a physics step in which two act gets their weighted mean."""

    def __init__(self, delay_s: float, step_s: float) -> None:
        """Make room for commands on their way; `step_s` is the physics step."""
        steps, self._share = divmod(delay_s / step_s, 1)
        self._commands: deque[FloatArray] = deque(maxlen=int(steps) + 2)

    def begin(self, command_rad: FloatArray) -> None:
        """Start as if these (n, j) position targets had always been commanded."""
        for _ in range(self._commands.maxlen or 0):
            self._commands.append(command_rad)

    def step(self, command_rad: FloatArray) -> FloatArray:
        """Take a step's (n, j) command; return the delayed one that acts in it."""
        self._commands.append(command_rad)
        older, newer = self._commands[0], self._commands[1]
        return (1 - self._share) * newer + self._share * older


class LateEncoders:
    """Delays measured joint positions and velocities, interpolating between steps."""

    def __init__(self, delay_s: float, step_s: float) -> None:
        """Make room for past measurements; `step_s` is the physics step."""
        steps, self._share = divmod(delay_s / step_s, 1)
        self._step_s = step_s
        self._states: deque[tuple[FloatArray, FloatArray]] = deque(
            maxlen=int(steps) + 2
        )

    def begin(self, position_rad: FloatArray, velocity_rad_s: FloatArray) -> None:
        """Start as if joint positions and velocities (n, j) had always been these."""
        for _ in range(self._states.maxlen or 0):
            self.note(position_rad, velocity_rad_s)

    def note(self, position_rad: FloatArray, velocity_rad_s: FloatArray) -> None:
        """Store the true joint positions and velocities (n, j) after a physics step."""
        self._states.append((position_rad.copy(), velocity_rad_s.copy()))

    def seen(self) -> tuple[FloatArray, FloatArray]:
        """Late joint positions and velocities (n, j) that the encoders report now."""
        older, newer = self._states[0], self._states[1]
        return hermite(older, newer, self._step_s, 1 - self._share)


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
        self._commands = LateCommands(float(signals.command_delay_s[0]), step_s)
        self._encoders = LateEncoders(float(signals.sensor_delay_s[0]), step_s)
        self._gyro_bias_rad_s = signals.gyro_bias_rad_s
        return batch

    def _start(self, pose_rad: FloatArray) -> None:
        super()._start(pose_rad)
        if self._laws is not None:
            self._steps = 0
            self._laws.begin(pose_rad)
            self._commands.begin(pose_rad)
            _, velocity = self._laws.joint_state()
            self._encoders.begin(self._laws.encoder_rad(), velocity)

    def _advance(self, schedule: Schedule) -> None:
        if self._laws is None:
            super()._advance(schedule)
            return
        for targets, steps in schedule:
            for _ in range(steps):
                now_s = np.array([self._steps * self.options.timestep_s])
                self._laws.servo(self._commands.step(targets), now_s)
                self._laws.outside.apply(now_s)
                self._run(1)
                self._steps += 1
                _, velocity = self._laws.joint_state()
                self._encoders.note(self._laws.encoder_rad(), velocity)

    def _read(self) -> tuple[Truth, Observation]:
        """Read truth and observation; sensor effects act on the observation only."""
        truth, observation = super()._read()
        if self._laws is None:
            return truth, observation
        position, velocity = self._encoders.seen()
        return truth, replace(
            observation,
            position_rad=position + self._laws.joints["offset_rad"],
            velocity_rad_s=velocity,
            gyroscope_rad_s=observation.gyroscope_rad_s + self._gyro_bias_rad_s,
        )
