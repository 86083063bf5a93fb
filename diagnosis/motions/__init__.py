"""Motions that excite the physics of a robot: their shapes, and plans within limits."""
