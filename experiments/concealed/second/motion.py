"""Motions, clocks, sensors and controllers of the test cases of set 2.

None of them depends on the kind of the case.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from experiments.concealed.motion import SOFT, SOFT_MOTIONS, CaseMotion
from experiments.concealed.second.plan import CasePlan
from experiments.motions import MOTIONS
from worlds.hidden import Hidden, HiddenPlant
from worlds.hidden.limbs import limb_plant
from worlds.hidden.recorded import HiddenSensors

DURATION_S, SHORT_S = (8.0, 10.0), (8.0, 8.5)
"""Range of a recording's duration [s]; for high rates, whose rows are many, the second
one."""
_MANY_HZ = 500.0
"""Tick rate [Hz] from which recordings are short."""
STEP_S, FINE_STEP_S = 0.00025, 0.000125
"""Physics steps [s]; the finer one for high rates, whose short ticks jitter, too."""
JITTER_S, JITTER_SHARE = (1e-4, 1e-3), 0.1
"""Range of a time stamp's largest error [s], and its limit as a share of a tick."""
LEAST_STEPS = 0.75
"""Least of that error in physics steps, so that ticks move by whole ones."""
_SMOOTH = ("multisine", "chirp", "multisine", "ramps")
"""Motions of a robot with an unknown controller: arms that report torques plan smooth
paths."""
_CONTROL_HZ = 400.0
"""An unknown controller gets a new target at least so often [Hz]; rows are fewer."""
_QUANTA = {12: 0.3, 14: 0.3, 16: 0.2, 18: 0.2}
"""Share of the test cases by the encoders' resolution in bits per turn."""
_ENCODER_RAD = (2e-5, 6e-4)
"""Range of the encoders' noise [rad], drawn evenly in the logarithm."""
_TORQUE_SHARE = (0.001, 0.01)
"""Range of measured torques' noise as a share of the largest torque, likewise."""
_STIFFER, _SOFTER = (1.0, 4.0), (0.7, 1.3)
"""Ranges of an unknown controller's stiffness and damping: multiples of the plain
servo's stiffness, and of the damping that keeps the damping ratio."""
_INTEGRAL_S = (0.2, 2.0)
"""Range of an unknown controller's integral time [s]; every second one has none."""


@dataclass(frozen=True, eq=False)
class SecondMotion:
    """The motions of a case of set 2.

    Attributes:
      motion: motions, with commands at the controller's rate.
      before: other motions, for recordings of the healthy robot.
      controller: unknown gains of the controller, as hidden effects; () where the
        recordings state the gains.
      sensors: the sensors.
      every: ticks of the controller from one row of a recording to the next.
      step_s: physics step.
    """

    motion: CaseMotion
    before: CaseMotion
    controller: tuple[Hidden, ...]
    sensors: HiddenSensors
    every: int
    step_s: float

    @classmethod
    def drawn(cls, plan: CasePlan, rng: np.random.Generator) -> "SecondMotion":
        """Draw motions, sensors and controller of a case as it is planned."""
        plant = limb_plant(plan.robot)
        torques = plan.drive == "torques"
        names = _SMOOTH if torques else MOTIONS
        every = math.ceil(_CONTROL_HZ / plan.rate_hz) if torques else 1
        low, high = plant.range_rad.T
        middle = 0.5 + 0.4 * rng.uniform(-0.5, 0.5, len(low))
        lengths = SHORT_S if plan.rate_hz >= _MANY_HZ else DURATION_S
        duration_s = float(rng.uniform(*lengths))
        rate_hz = float(plan.rate_hz * every)
        step_s = FINE_STEP_S if plan.rate_hz >= _MANY_HZ else STEP_S
        most_s = min(JITTER_S[1], JITTER_SHARE / plan.rate_hz)
        least_s = min(max(JITTER_S[0], LEAST_STEPS * step_s), most_s)
        seeds = [int(seed) for seed in rng.integers(2**32, size=2 * len(names))]
        given = plant.with_gains(float(rng.uniform(0.8, 1.25)))
        motion = CaseMotion(
            plant=given,
            plants=_known_gains(given, names, plan.gains),
            names=names,
            places=tuple(range(len(low))),
            moves=np.ones(len(low), bool),
            centre_rad=low + middle * (high - low),
            rate_hz=rate_hz,
            spans_s=tuple((float(b), duration_s) for b in rng.uniform(0.3, 1.2, 4)),
            jitter_s=_log_uniform(least_s, most_s, rng),
            seeds=tuple(seeds[: len(names)]),
        )
        # the controller's own ticks may not jitter more than they are apart
        jitter_s = min(motion.jitter_s, JITTER_SHARE / rate_hz)
        motion = replace(motion, jitter_s=jitter_s)
        return cls(
            motion,
            replace(motion, seeds=tuple(seeds[len(names) :])),
            _controller(given, rng) if torques else (),
            _sensors(rng),
            every,
            step_s,
        )


def _known_gains(
    plant: HiddenPlant, names: Sequence[str], gains: int
) -> tuple[HiddenPlant, ...]:
    """The robot in each recording: the same, or with half the gains in some."""
    softer = plant.with_gains(SOFT, SOFT) if gains == 2 else plant
    return tuple(softer if name in SOFT_MOTIONS else plant for name in names)


def _controller(plant: HiddenPlant, rng: np.random.Generator) -> tuple[Hidden, ...]:
    """Draw the gains of an unknown controller, the same for all recordings."""
    stiffer = _log_uniform(*_STIFFER, rng)
    damping = math.sqrt(stiffer) * float(rng.uniform(*_SOFTER))
    time_s = _log_uniform(*_INTEGRAL_S, rng)
    integral = rng.uniform() < 0.5
    effects = []
    for joint in plant.joints:
        effects += [
            Hidden("servo_gain", joint, {"factor": stiffer}),
            Hidden("servo_damping", joint, {"factor": damping}),
        ]
        if integral:
            effects.append(Hidden("integral_term", joint, {"time": time_s}))
    return tuple(effects)


def _sensors(rng: np.random.Generator) -> HiddenSensors:
    bits = int(rng.choice(list(_QUANTA), p=list(_QUANTA.values())))
    return HiddenSensors(
        quantum_rad=2 * math.pi / 2**bits,
        encoder_rad=_log_uniform(*_ENCODER_RAD, rng),
        torque_share=_log_uniform(*_TORQUE_SHARE, rng),
    )


def _log_uniform(low: float, high: float, rng: np.random.Generator) -> float:
    """A random number from `low` to `high`, evenly in the logarithm."""
    return math.exp(rng.uniform(math.log(low), math.log(high)))
