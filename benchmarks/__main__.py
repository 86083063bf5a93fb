"""`make bench`: every benchmark; the exit status says whether all pass."""

import sys

from benchmarks.control_loop import measure, report


def main() -> int:
    """Print each report."""
    text, passes = report(measure())
    print(text)
    return 0 if passes else 1


if __name__ == "__main__":
    sys.exit(main())
