"""`groundwalk doctor`: says what is installed, what is missing, and how to fix it."""

import argparse
import dataclasses
import json
import sys
from collections.abc import Sequence
from dataclasses import dataclass

from experiments.reports.tables import print_table
from experiments.runs.doctor_checks import Finding, State, examine

COLOURS = {State.OK: "green", State.NOTE: "yellow", State.FAIL: "red"}


@dataclass(frozen=True)
class DoctorConfig:
    """Say what is installed, what is missing and what to do about it."""

    json: bool = False
    """Print the findings as JSON."""


def print_findings(findings: Sequence[Finding]) -> None:
    """Print the findings as a table, one line each; in colours on a terminal."""
    rows = [(one.state, one.name, one.found, one.advice) for one in findings]
    colours = [COLOURS[one.state] for one in findings]
    print_table(("", "what", "found", "what to do"), rows, colours)


def main(config: DoctorConfig) -> int:
    """Print the findings of all checks; the exit status is 1 if one fails."""
    findings = examine()
    works = all(finding.state is not State.FAIL for finding in findings)
    if config.json:
        rows = [dataclasses.asdict(finding) for finding in findings]
        print(json.dumps({"works": works, "findings": rows}, indent=2))
    else:
        print_findings(findings)
    return 0 if works else 1


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=DoctorConfig.__doc__)
    parser.add_argument("--json", action="store_true", help="findings as JSON")
    sys.exit(main(DoctorConfig(**vars(parser.parse_args()))))
