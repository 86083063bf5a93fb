"""Gravity, as both worlds have it."""

GRAVITY_M_S2 = 9.81
"""On Earth, rounded as physics engines round it."""
