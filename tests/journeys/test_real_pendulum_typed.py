"""The five commands of docs/your_robot.md for a real pendulum, if it is at hand."""

import json
from pathlib import Path

import pyarrow.csv
import pyarrow.parquet
import pytest
from kinds_of_steps import Run, below
from small import DIAGNOSED, PREDICTED
from travel import ROOT, take
from typed_pages import typed

PENDULUM = ROOT / ".." / "shared" / "data" / "labelled" / "pendulum_viscous"
ARM = "my_arm.urdf --servo mx-64@12V,P=32"
LAST = "Y_vad1"
"""The recording that is predicted; the diagnosis gets the others."""
NATIVE = "corrected.xml", "corrected.json"
"""What a diagnosis writes beside its report where MuJoCo has all effects."""
COLUMNS = {
    "time": "time_s",
    "position.axis": "axis_pos_rad",
    "command_torque.axis": "axis_torque_nm",
}

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        not PENDULUM.is_dir(), reason="no real recordings in ../shared/data"
    ),
]


def write_logs(folder: Path) -> None:
    """The recordings as a logger might have written them, and the model's file."""
    (folder / "logs").mkdir()
    (folder / "model.xml").write_bytes((PENDULUM / "model.xml").read_bytes())
    for path in sorted((PENDULUM / "recordings").glob("*.parquet")):
        table = pyarrow.parquet.read_table(path).select(list(COLUMNS))
        name = "tuesday" if path.stem == LAST else f"logs/{path.stem}"
        table = table.rename_columns(list(COLUMNS.values()))
        pyarrow.csv.write_csv(table, folder / f"{name}.csv")


def test_from_logs_of_a_passive_pendulum_to_a_prediction(tmp_path: Path) -> None:
    """Its viscous friction is known, see `truth.json`; there is no dry friction."""
    write_logs(tmp_path)
    steps = [
        Run(writes=("recordings/Y_id0.parquet",), says="torque"),
        Run(writes=("runs/check/report.html",), says="can be diagnosed"),
        Run(writes=below("runs/arm", (*DIAGNOSED, *NATIVE)), says="viscous"),
        Run(writes=("tuesday.parquet",), says="axis"),
        Run(writes=below("runs/tuesday", PREDICTED), says="holds"),
    ]
    commands = typed(ROOT / "docs" / "your_robot.md")[: len(steps)]
    for command, step in zip(commands, steps, strict=True):
        take(tmp_path, command.replace(ARM, "model.xml"), step)
    verdict = json.loads((tmp_path / "runs" / "arm" / "diagnosis.json").read_text())
    found = {one["name"]: one["parameters"] for one in verdict["effects"]}
    assert "coulomb_friction" not in found
    assert 1.7e-4 < found["viscous_friction"]["coefficient"]["value"] < 2.5e-4
