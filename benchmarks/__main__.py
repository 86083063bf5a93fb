"""Runs all benchmarks (`make bench`); the exit status is 0 if all pass, else 1."""

import sys

from benchmarks import candidate_fit, check_recordings, control_loop, grounded_loop


def main() -> int:
    """Run all benchmarks, print their reports, and return the exit status."""
    failed = 0
    for benchmark in (control_loop, grounded_loop, candidate_fit, check_recordings):
        text, passes = benchmark.report(benchmark.measure())
        print(text, flush=True)
        failed += not passes
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
