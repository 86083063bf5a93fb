"""`groundwalk doctor`: what is installed, what is missing, and what to do about it."""

import argparse
import dataclasses
import importlib.util
import json
import sys
from collections.abc import Sequence
from dataclasses import dataclass

from experiments.runs.doctor_checks import Finding, State, examine


@dataclass(frozen=True)
class DoctorConfig:
    """Say what is installed, what is missing and what to do about it."""

    json: bool = False
    """Print the findings as JSON."""


def print_lines(findings: Sequence[Finding]) -> None:
    """The findings as plain text, one line each."""
    for finding in findings:
        advice = f" -> {finding.advice}" if finding.advice else ""
        print(f"{finding.state:5}{finding.name:20}{finding.found}{advice}")


def print_table(findings: Sequence[Finding]) -> None:
    """The findings as a table in colours, for a terminal."""
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    colours = {State.OK: "green", State.NOTE: "yellow", State.FAIL: "red"}
    table = Table("", "what", "found", "what to do", box=None)
    for finding in findings:
        colour = colours[finding.state]
        texts = (finding.name, finding.found, finding.advice)
        table.add_row(f"[{colour}]{finding.state}[/]", *map(escape, texts))
    Console().print(table)


def main(config: DoctorConfig) -> int:
    """Report; 0 if everything that is required works, else 1."""
    findings = examine()
    works = all(finding.state is not State.FAIL for finding in findings)
    if config.json:
        rows = [dataclasses.asdict(finding) for finding in findings]
        print(json.dumps({"works": works, "findings": rows}, indent=2))
    elif sys.stdout.isatty() and importlib.util.find_spec("rich"):
        print_table(findings)
    else:
        print_lines(findings)
    return 0 if works else 1


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=DoctorConfig.__doc__)
    parser.add_argument("--json", action="store_true", help="findings as JSON")
    sys.exit(main(DoctorConfig(**vars(parser.parse_args()))))
