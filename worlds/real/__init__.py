"""The uneven world: PyBullet, robots spread over processes (`RealWorld`)."""
