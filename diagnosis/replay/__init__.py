"""Replays: recorded commands simulated with variants of a robot model.

`replay.replay` runs all variants through all recordings in one batch of MuJoCo
simulations and returns predicted measurements. At every step `laws` applies effects
that MuJoCo lacks.
"""
