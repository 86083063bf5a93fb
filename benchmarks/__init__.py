"""Benchmarks of speed, as ratios of times, which hardly depend on the machine."""
