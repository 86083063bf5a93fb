"""Gravity, as both simulated worlds have it."""

GRAVITY_M_S2 = 9.81
"""Standard gravity, rounded to two digits as MuJoCo and PyBullet users do."""
