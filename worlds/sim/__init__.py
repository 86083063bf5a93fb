"""The deterministic world: MuJoCo."""
