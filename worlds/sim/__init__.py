"""The deterministic world: MuJoCo, many robots in one batch (`SimWorld`)."""
