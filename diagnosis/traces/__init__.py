"""Recordings made ready to be held against a plant: read, cut, smoothed, split."""
