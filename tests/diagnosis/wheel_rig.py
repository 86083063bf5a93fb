"""A wheel that a servo or a torque turns: its law, and runs of it."""

import numpy as np
from joint_rigs import (
    INERTIA,
    WHEEL,
    plant_of,
    run_from,
    smooth_command,
    ticks,
    trace_of,
)

KP, KD, EMF, LIMIT = 3.0, 0.1, 0.05, 0.4
HINGE = "hinge"
TIME_S = ticks(0.8)
COMMAND = smooth_command(TIME_S)
TOLERANCE = 1e-5
"""Of positions whose first-order error is taken out [rad]."""


def wheel(kp=KP, kd=KD, limit=np.inf, emf=EMF, **more):
    return plant_of(WHEEL, kp=kp, kd=kd, limit=limit, emf=emf, **more)


def commanded(plant, command=COMMAND, time_s=TIME_S, **start):
    return run_from(trace_of(plant, time_s, command_rad=command), **start)


def driven(torque, time_s=TIME_S, plant=None, **start):
    plant = plant or plant_of(WHEEL)
    return plant, run_from(trace_of(plant, time_s, command_torque_nm=torque), **start)


def servo_law(command=COMMAND, kp=KP, kd=KD, limit=np.inf, emf=EMF, load=None):
    """I v' = clip(kp (c - q) - kd v, +-limit) - emf v - load."""

    def law(t, y, k):
        q, v = y
        gain = kp(t) if callable(kp) else kp
        target = command(t) if callable(command) else command[k]
        torque = np.clip(gain * (target - q) - kd * v, -limit, limit) - emf * v
        return [v, (torque - (load(q) if load else 0.0)) / INERTIA]

    return law
