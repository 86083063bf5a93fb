"""How large the doctoring of a case is: drawn evenly in the logarithm."""

import math

import numpy as np

SIZES = {
    "servo_gain": (math.log(1.05), math.log(2.0)),
    "torque_scale": (math.log(1.05), math.log(2.0)),
    "command_latency": (0.005, 0.1),
    "encoder_offset": (0.01, 0.2),
    "payload_mass": (0.1, 0.8),
    "viscous_friction": (0.25, 1.0),
    "coulomb_friction": (0.25, 1.0),
}
"""Smallest and largest size: of factors the logarithm (either sign), of latencies
seconds, of offsets radians (either sign), of what is taken out of a model the share
that is taken."""
TIME_FACTOR = 1.02
"""The factor on the times of a case whose clock is wrong: crystals are a hundred times
better, but a nominal rate that was written down instead of the true one is not."""


def drawn_size(effect: str, rng: np.random.Generator) -> float:
    """Draw the size of a doctoring; it depends on the effect's name only."""
    low, high = SIZES[effect]
    return math.exp(rng.uniform(math.log(low), math.log(high)))
