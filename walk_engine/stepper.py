"""The sequence of steps: state of each robot from tick to tick, and its feet.

The foot force sensors detect when the weight has moved to the other foot.
"""

from typing import NamedTuple, TypeVar

import numpy as np

from groundwalk.arrays import BoolArray, FloatArray
from robots.leg_geometry import Biped
from walk_engine.engine_config import EngineConfig
from walk_engine.feet import Feet, feet_in_step, resting_feet
from walk_engine.step_plan import (
    GaitColumns,
    Speeds,
    StepPlan,
    Velocity,
    plan_step,
    within_limits,
)
from walk_engine.walk_state import (
    StateArray,
    WalkState,
    crouched,
    is_resting,
    is_stepping,
    on_request,
    when_over,
)

_UNLOADED = 1e-6
"""Sum of the readings of all force sensors, each as a share of its largest reading,
below which no foot carries weight; it only has to exceed rounding errors."""

_LEFT, _RIGHT = (0, 1, 2, 3), (5, 4, 7, 6)
"""Indices of the left foot's force sensors, and of their mirror images on the right."""


class Sensing(NamedTuple):
    """The state of the force sensing of n robots.

    Attributes:
      largest_n: (8, n) each sensor's largest reading so far, used as its scale.
      side: (n,) the side that carried the weight last: 1 left, -1 right, 0 unknown.
    """

    largest_n: FloatArray
    side: FloatArray


def nothing_sensed(robots: int, config: EngineConfig) -> Sensing:
    """State of the force sensing of some robots before the first reading."""
    return Sensing(np.full((8, robots), config.sensor_start_n), np.zeros(robots))


def sense(
    before: Sensing, force_n: FloatArray, lateral_m: FloatArray, config: EngineConfig
) -> Sensing:
    """Update the state of the force sensing with readings (8, n) of the sensors [N].

    While no foot carries weight, the last side is kept. (rUNSWift's Walk2014 assumes
    the middle then, and misses a crossing in such a tick.) `lateral_m` (8,) are the
    sensors' positions left of the torso's middle [m].
    """
    largest_n = np.clip(force_n, before.largest_n, config.sensor_full_n)
    pressure = np.maximum(force_n, 0.0) / largest_n
    cop_m = _lateral_cop_m(pressure, lateral_m)
    return Sensing(largest_n, np.where(cop_m == 0, before.side, np.sign(cop_m)))


def step_is_over(
    time_s: FloatArray,
    period_s: FloatArray,
    has_crossed: BoolArray,
    min_phase: FloatArray,
    config: EngineConfig,
) -> BoolArray:
    """(n,) whether the step is over, so that the support foot changes.

    A step is over when the weight moves to the robot's other side, but not before
    `min_phase` (n,) periods, and at the latest after `config.timeout_periods` periods.
    In this way a step of rUNSWift's Walk2014 adapts to pushes and uneven ground.
    """
    late_enough = time_s > min_phase * period_s
    too_late = time_s > config.timeout_periods * period_s
    return (late_enough & has_crossed) | too_late


def sensor_lateral_m(biped: Biped) -> FloatArray:
    """(8,) lateral positions of the force sensors [m], positive left of the middle.

    The feet are assumed to be straight below the hips.
    """
    hip_m = biped.leg.hip_m[1]
    hips_m: FloatArray = np.repeat([hip_m, -hip_m], 4)
    return biped.foot_sensor_xy_m[:, 1] + hips_m


def _lateral_cop_m(pressure: FloatArray, lateral_m: FloatArray) -> FloatArray:
    """Lateral centre of pressure (n,) [m], left positive; 0 without load."""
    moment = total = np.zeros(pressure.shape[1])
    for left, right in zip(_LEFT, _RIGHT, strict=True):
        moment = moment + (
            lateral_m[left] * pressure[left] + lateral_m[right] * pressure[right]
        )
        total = total + (pressure[left] + pressure[right])
    loaded = total > _UNLOADED
    return np.where(loaded, moment / np.where(loaded, total, 1.0), 0.0)


Record = TypeVar("Record", bound=NamedTuple)


def select(chosen: BoolArray, new: Record, old: Record) -> Record:
    """Merge NamedTuples of arrays (..., n): `new` for robots chosen, else `old`."""
    fields = (
        select(chosen, one, other)
        if isinstance(one, tuple)
        else np.where(chosen, one, other)
        for one, other in zip(new, old, strict=True)
    )
    return new._make(fields)


class Progress(NamedTuple):
    """State and progress of n robots within their steps.

    Attributes:
      state: (n,) the robots' states, `WalkState`.
      ticks: (n,) ticks since the step, crouching or rising began; 0 at rest.
      left_swings: (n,) whether the left foot swings; at rest, whether it swings next.
      plan: the plan of the current step.
      origin: positions of the feet when the step began.
      sensing: the state of the force sensing.
    """

    state: StateArray
    ticks: FloatArray
    left_swings: BoolArray
    plan: StepPlan
    origin: Feet
    sensing: Sensing

    @property
    def support(self) -> StateArray:
        """(n,) the foot that supports: 1 left, -1 right, 0 both."""
        foot = np.where(self.left_swings, -1, 1)
        return np.where(is_stepping(self.state), foot, 0).astype(np.int8)


class Stepper:
    """Advances the steps of n equal robots from tick to tick."""

    def __init__(
        self, biped: Biped, gait: GaitColumns, tick_s: float, config: EngineConfig
    ) -> None:
        """Keep the gaits' parameters, the tick [s] and the constants."""
        self._leg = biped.leg
        self._gait = gait
        self._tick_s = tick_s
        self._config = config
        self._lateral_m = sensor_lateral_m(biped)
        self._leg_height_m = gait["hip_height"] - biped.leg.ankle_height_m
        self._resting = resting_feet(gait["com_offset"])
        self._still = Speeds(*np.zeros((3, len(self._leg_height_m))))

    def start(self, left_first: bool) -> Progress:
        """Progress of robots in the state READY."""
        n = len(self._leg_height_m)
        return Progress(
            state=np.full(n, WalkState.READY, dtype=np.int8),
            ticks=np.zeros(n),
            left_swings=np.full(n, left_first),
            plan=self._plan(self._still, np.zeros(n, dtype=np.bool_)),
            origin=self._resting,
            sensing=nothing_sensed(n, self._config),
        )

    def advance(
        self, before: Progress, request: Velocity, force_n: FloatArray
    ) -> tuple[Progress, Feet, FloatArray]:
        """Advance all robots by one tick, with readings (8, n) of the sensors [N].

        The result is the new progress, the positions of the feet, and the depth (n,) of
        each robot's crouch: 0 standing upright, 1 at the walking height.
        """
        now = self._begin(before, request)
        time_s = now.ticks * self._tick_s
        own = self._gait, self._leg_height_m, self._config
        feet = feet_in_step(time_s, now.plan, now.origin, now.left_swings, *own)
        feet = select(is_stepping(now.state), feet, self._resting)
        down = crouched(now.state, time_s, self._config.posture_s)
        sensing = sense(now.sensing, force_n, self._lateral_m, self._config)
        return self._end(now, time_s, feet, sensing), feet, down

    def _begin(self, before: Progress, request: Velocity) -> Progress:
        """Begin a tick: robots that start a step read the request and plan the step."""
        reads = before.ticks == 0
        speeds = within_limits(request, self._gait, self._config)
        stand = np.broadcast_to(request.stand, reads.shape)
        walk = speeds.moving & ~stand
        state = np.where(reads, on_request(before.state, walk, stand), before.state)
        speeds = select(walk, speeds, self._still)
        plan = self._plan(speeds, state == WalkState.STARTING)
        return before._replace(
            state=state,
            ticks=np.where(is_resting(state), 0.0, before.ticks + 1.0),
            plan=select(reads, plan, before.plan),
        )

    def _end(
        self, now: Progress, time_s: FloatArray, feet: Feet, sensing: Sensing
    ) -> Progress:
        """End a tick: update robots whose step, crouching or rising is over."""
        config, period_s = self._config, now.plan.period_s
        has_crossed = now.sensing.side * sensing.side < 0
        least = self._gait["switch_min_phase"]
        changes = step_is_over(time_s, period_s, has_crossed, least, config)
        # The last step ends when both feet are down side by side.
        stops = time_s >= period_s
        steps = is_stepping(now.state)
        step_over = steps & np.where(now.state == WalkState.STOPPING, stops, changes)
        move_over = ~steps & (time_s >= config.posture_s)
        over = step_over | move_over
        # The foot that carries less weight swings next; if unknown, they take turns.
        swing = np.where(sensing.side == 0, ~now.left_swings, sensing.side < 0)
        return now._replace(
            state=np.where(over, when_over(now.state), now.state),
            ticks=np.where(over, 0.0, now.ticks),
            left_swings=np.where(step_over, swing, now.left_swings),
            origin=select(step_over, feet, now.origin),
            sensing=sensing,
        )

    def _plan(self, speeds: Speeds, starting: BoolArray) -> StepPlan:
        """Plan a step of each robot; `starting` (n,) marks a robot's first step."""
        return plan_step(speeds, starting, self._gait, self._leg, self._config)
