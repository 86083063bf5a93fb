"""The uneven world: PyBullet."""
