"""`groundwalk predict`: checks a diagnosis' corrected sim on new recordings."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import numpy as np
import tyro

from diagnosis import Hooks, predict, read_traces
from diagnosis.traces.trace import DriveBy
from experiments.command_line import run_verb
from experiments.diagnose import AUDIT
from experiments.prediction.diagnosed import DiagnosisRun
from experiments.prediction.page import (
    COLUMNS,
    MOST_ROWS,
    console_lines,
    rows_of,
    write_page,
)
from experiments.prediction.result import PredictionResult, result_of
from experiments.prediction.used import sort_out
from experiments.reports.report import REPORT
from experiments.reports.tables import print_folder, print_table
from experiments.runs.extras import extra
from experiments.runs.folder import RESULT, RunFolder, check_free
from experiments.runs.options import check_at_least
from experiments.runs.progress import Stages
from experiments.runs.recording_options import RecordingOptions
from groundwalk.errors import BadRecordingError, BadValueError

VERB = "predict"
_GAINS = ("servo", "kp", "kd", "max_torque")


@dataclass(frozen=True)
class Predict:
    """Check the corrected sim of a diagnosis on recordings that it has not seen.

    Attributes:
      run: folder of a run of `groundwalk diagnose` that has found effects.
      recordings: new recordings of the same robot (Parquet or CSV), or folders of them.
      robot: the robot's model, if its file is no longer where it was in the run.
      servo: type of all servos, such as sts3215@7.4V,P=16, for recordings that do not
        state their gains; by default that of the run, as are the next three.
      kp: stiffness of all servos [N m/rad], for recordings that do not state it.
      kd: damping of all servos [N m s/rad], for recordings that do not state it.
      max_torque: torque limit of all servos [N m], for recordings that do not state it.
      drive: what moves the model's joints where both commands and torques were
        recorded: servos or torques; by default that of the run.
      seed: every random number follows from it.
      threads: processor threads of the replays.
      out: folder of the result; a new one under runs/ by default.
      json: print the result as JSON.

    Example:
      >>> predict_recordings(Predict(Path("runs/elbow"), (Path("c.parquet"),)))
    """

    run: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="RUN")]
    recordings: Annotated[
        tuple[Path, ...], tyro.conf.Positional, tyro.conf.arg(metavar="RECORDING...")
    ] = ()
    robot: str = ""
    servo: str = ""
    kp: float | None = None
    kd: float | None = None
    max_torque: float | None = None
    drive: DriveBy | None = None
    seed: int = 1
    threads: int = 2
    out: Path | None = None
    json: bool = False

    def __post_init__(self) -> None:
        """Refuse invalid options before anything is read."""
        check_at_least(self, seed=0, threads=0)
        if not self.recordings:
            raise BadValueError(
                f"no recording is given; give one at least, after {self.run}"
            )

    def as_in(self, run: DiagnosisRun) -> RecordingOptions:
        """The options of the run, with its recordings replaced by the new ones."""
        given = {name: getattr(self, name) for name in _GAINS}
        if set(given.values()) == {None, ""}:
            given = {name: run.options[name] for name in _GAINS if name in run.options}
        drive = self.drive or run.options.get("drive", "servos")
        robot = run.robot(self.robot)
        return RecordingOptions(self.recordings, robot, drive=drive, **given)


def main(config: Predict) -> None:
    """Predict the recordings, and print judgement and errors."""
    folder, result = predict_recordings(config)
    if config.json:
        print(result.to_json(), end="")
        return
    lines = console_lines(result)
    print(*(f"{label:<12}{text}" for label, text in lines), "", sep="\n")
    print_table(COLUMNS, rows_of(result, MOST_ROWS))
    print_folder(folder.path)


def predict_recordings(config: Predict) -> tuple[RunFolder, PredictionResult]:
    """Predict recordings by a diagnosis' sims, and write result, page and pictures.

    The run's folder is made when the result is known: bad input leaves nothing behind.

    Example:
      >>> predict_recordings(Predict(Path("runs/elbow"), (Path("c.parquet"),)))
    """
    check_free(config.out)
    run = DiagnosisRun.read(config.run)
    asked = config.as_in(run)
    recordings = sort_out(config.recordings, run.recordings)
    plant, traces = read_traces(recordings.new, asked.robot, asked.gains)
    run.check_joints(plant)
    before, after, events = run.sims(plant)
    with Stages("prediction", config.threads) as stages:
        options = asked.drive, config.threads, run.creeps, Hooks(stages)
        found = predict(plant, traces, after, before, *options)
    _check_compared(run, [*found.channels])
    seed = np.random.SeedSequence(config.seed)
    own = run.verdict, events, recordings.used, recordings.limits, seed
    result = result_of(found, *own)
    folder = RunFolder.create(VERB, replace(config, robot=asked.robot))
    folder.write_text(RESULT, result.to_json())
    folder.write_text(AUDIT, found.audit.to_json() + "\n")
    with extra(REPORT):
        write_page(folder, result, found.series())
    return folder, result


def _check_compared(run: DiagnosisRun, channels: list[str]) -> None:
    """Refuse recordings in which other quantities are compared than in the run."""
    by_torque = all(name.startswith("torque.") for name in channels)
    if run.compares_torques and not by_torque and run.options.get("reference"):
        raise BadRecordingError(
            "the diagnosis compared torques by what its reference taught, which its "
            "run does not keep: such a diagnosis cannot be checked on new recordings"
        )
    if run.compares_torques not in (None, by_torque):
        ours, theirs = ("torques", "motions") if by_torque else ("motions", "torques")
        raise BadRecordingError(
            f"the diagnosis compared {theirs}, in these recordings only {ours} can be "
            "compared: record the same quantities, with servos of the same kind"
        )


if __name__ == "__main__":
    run_verb(Predict, main)
