"""Recordings of a three-joint arm whose loss torques are known in closed form."""

import numpy as np
import torque_arm

from diagnosis.plant.plant import inverse_dynamics
from diagnosis.traces.trace import Trace

TICK_S = 0.01
NOISE_NM = 0.02


def nothing(q, v, needed):
    """No loss torque."""
    return 0.0


def moved(loss=nothing, seed=0, duration_s=12.0, noise_nm=NOISE_NM):
    """A recording of the arm, whose torques are those needed and a loss torque.

    Args:
      loss: function of positions, velocities and needed torques (T, 3); returns (T, 3).
      seed: of motion and noise.
      duration_s: how long.
      noise_nm: standard deviation of the torque sensors' noise.
    """
    random = np.random.default_rng(seed)
    time_s = np.arange(round(duration_s / TICK_S)) * TICK_S
    rates = random.uniform(0.5, 4, (3, 4))
    phases = random.uniform(0, 6, (3, 4))
    angle = rates[..., None] * time_s + phases[..., None]
    size = 0.3
    q = size * np.sin(angle).sum(axis=1).T
    v = size * (rates[..., None] * np.cos(angle)).sum(axis=1).T
    a = -size * (rates[..., None] ** 2 * np.sin(angle)).sum(axis=1).T
    plant = torque_arm.arm()
    needed = inverse_dynamics(plant, plant.model, q, v, a)
    torque = needed + loss(q, v, needed) + noise_nm * random.standard_normal(q.shape)
    servo = torque_arm.servo_of(3)
    return Trace(f"arm {seed}", time_s, q, servo, torque_nm=torque)


def recordings(loss=nothing, count=4, **options):
    """Several recordings with the same loss torque."""
    return [moved(loss, seed, **options) for seed in range(count)]
