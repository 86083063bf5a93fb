"""The gravity of both simulated worlds, MuJoCo and PyBullet."""

GRAVITY_M_S2 = 9.81
"""Acceleration of gravity [m/s^2]: standard gravity 9.80665, rounded as MuJoCo does."""
