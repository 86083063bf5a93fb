"""The commands of docs/recordings.md for two real bags, if these are at hand."""

import json
from pathlib import Path

import pytest
from kinds_of_steps import Run, below
from small import DIAGNOSED
from travel import ROOT, take
from typed_pages import typed

BAGS = ROOT / ".." / "shared" / "data" / "bags"
PAGE = ROOT / "docs" / "recordings.md"

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        not BAGS.is_dir(), reason="no real recordings in ../shared/data"
    ),
]


def step_of(command: str, arm: str) -> Run:
    """What a command must say and write, by its verb."""
    return {
        "convert": Run(writes=(f"{arm}.parquet",), says="torques from the efforts"),
        "check": Run(says="can be diagnosed"),
        "diagnose": Run(writes=below(f"runs/{arm}", DIAGNOSED), says="dry friction"),
    }[command.split()[1]]


@pytest.mark.parametrize("arm", ["ur10", "panda"])
def test_a_bag_by_three_commands(arm: str, tmp_path: Path) -> None:
    bag = f"{arm}_exciting.db3"
    (tmp_path / bag).symlink_to((BAGS / bag).resolve())
    commands = [one for one in typed(PAGE) if arm in one]
    assert [one.split()[1] for one in commands] == ["convert", "check", "diagnose"]
    for command in commands:
        take(tmp_path, command, step_of(command, arm))
    verdict = json.loads((tmp_path / "runs" / arm / "diagnosis.json").read_text())
    rubs = [e for e in verdict["effects"] if e["name"] == "coulomb_friction"]
    assert len(rubs) >= 5
    assert verdict["fit"]["corrected"] < 0.25 * verdict["fit"]["nominal"]
