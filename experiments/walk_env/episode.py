"""One robot that walks tick by tick, with additions to the walk engine's commands."""

import numpy as np

from experiments.walking.trials import TrialRules, Trials, start_pose
from groundwalk.arrays import FloatArray
from robots import biped
from walk_engine import Gait, Velocity, WalkEngine
from worlds import TICK_S, End, Observation, World


class WalkEpisode:
    """A trial as in `experiments.walking.trials.walk_trials`, one tick at a time.

    If nothing is added to the commands, it is equal to that trial to the last bit.
    `distance_m` is the distance so far along the x axis, after `ticks`.
    """

    def __init__(
        self, world: World, gait: Gait, rules: TrialRules, seed: np.random.SeedSequence
    ) -> None:
        """Put the world's only robot on its ground; the seed is that of its pose."""
        self._world, self._rules = world, rules
        self._engine = WalkEngine(biped(world.description), [gait], TICK_S)
        pose_rad = start_pose(self._engine, rules, [seed])
        self.observation: Observation = world.reset(pose_rad)
        self._start_m = world.truth().base_position_m[:, 0]
        self.ticks = 0
        self.distance_m = 0.0
        self._ask()

    def step(self, added_rad: FloatArray) -> None:
        """Walk for one tick with an addition (joints,) to the engine's command [rad].

        The sum is held within the joints' ranges. The engine does not see the addition.
        """
        low, high = self._world.description.joint_range_rad.T
        # the engine's own commands may be beyond a joint's range by rounding
        moved_rad = np.clip(self.command_rad + added_rad, low, high)
        given_rad = np.where(added_rad == 0, self.command_rad, moved_rad)
        self.observation = self._world.step(given_rad[None])
        self.ticks += 1
        here_m = self._world.truth().base_position_m[:, 0]
        self.distance_m = float((here_m - self._start_m)[0])
        course_m = self._rules.course_m
        if course_m is not None and self.distance_m >= course_m:
            self._world.stop(np.ones(1, bool))
        if not self.is_over:
            self._ask()

    @property
    def ended(self) -> End:
        """Why the rollout ended; `End.NONE` if time is up or it continues."""
        return self._world.ended[0]

    @property
    def is_over(self) -> bool:
        """Whether the trial is over."""
        out_of_time = self.ticks >= round(self._rules.limit_s / TICK_S)
        return out_of_time or not self._world.active[0]

    def senses(self) -> FloatArray:
        """(columns,) measurements of the last tick and the walk engine's next command.

        `WalkEnv` lists columns and units.
        """
        measured = list(vars(self.observation).values())[1:]
        engine = self._engine
        return np.concatenate(
            [
                *(values[0] for values in measured),
                self.command_rad,
                engine.support,
                engine.step_time_s,
            ]
        )

    def trials(self) -> Trials:
        """Result of the trial so far."""
        time_s = np.array([self.ticks * TICK_S])
        return Trials(np.array([self.distance_m]), time_s, (self.ended,))

    def _ask(self) -> None:
        """Get the walk engine's next command for the last measurements."""
        seen = self.observation
        self.command_rad: FloatArray = self._engine.step(
            Velocity.forward(), seen.gyroscope_rad_s, seen.foot_force_n
        )[0]
