"""Speed benchmarks; their results are ratios of times, which suit any machine."""
