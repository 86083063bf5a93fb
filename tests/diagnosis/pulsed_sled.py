"""A sled on a rough rail, its servo, and pulses that come in somewhere."""

import numpy as np
from joint_rigs import SLED, SLED_KG, plant_of, trace_of

KP, KD = 2000.0, 60.0
COULOMB_N, VISCOUS_N_S_M = 1.0, 3.0
FINE, TICK_S = 20, 0.002
PULSES_S = ((0.6, 0.9), (1.5, 1.8), (2.4, 2.7))
PULSE_N = 6.0


def sled():
    return plant_of(SLED, kp=KP, kd=KD)


def swinging(time_s):
    return 0.1 * np.sin(2.0 * time_s) + 0.03 * np.sin(7.0 * time_s)


def stepping(time_s):
    return 0.02 * (np.floor(time_s / 0.4) % 2)


def pulse_n(time_s):
    inside = [(start <= time_s) & (time_s < end) for start, end in PULSES_S]
    return PULSE_N * np.any(inside, axis=0)


def recorded(place=None, kp=KP, late_s=0.0, command=swinging, duration_s=3.2):
    """A trace of explicit steps of 0.1 ms.

    Args:
      place: where pulses come in: "actuator", "carriage", "torque sensor", "encoder".
      kp: that the servo really has.
      late_s: until a command takes effect.
      command: of the time.
      duration_s: of the recording.
    """
    step_s, steps = TICK_S / FINE, round(duration_s / TICK_S)
    x, v = 0.0, 0.0
    rows = np.zeros((steps, 2))
    for k in range(steps):
        now_s = k * TICK_S
        pulse = float(pulse_n(np.array(now_s)))
        asked = float(command(max(now_s - late_s, 0.0)))
        for i in range(FINE):
            servo = kp * (asked - x) - KD * v
            if i == 0:
                rows[k] = x, servo
            force = servo + pulse * (place in ("actuator", "carriage"))
            force -= VISCOUS_N_S_M * v + COULOMB_N * np.tanh(v / 1e-3)
            v += step_s * force / SLED_KG
            x += step_s * v
    time_s = np.arange(steps) * TICK_S
    position, torque = rows.T
    pulses = pulse_n(time_s)
    noise = np.random.default_rng(1).standard_normal((2, steps))
    return trace_of(
        sled(),
        time_s,
        position + (place == "encoder") * pulses / KP + 1e-7 * noise[0],
        command_rad=command(time_s),
        torque_nm=torque
        + pulses * (place in ("actuator", "torque sensor"))
        + 0.02 * noise[1],
    )
