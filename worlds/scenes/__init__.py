"""Recordings with what it takes to draw them: robot, ground, balance, curves."""
