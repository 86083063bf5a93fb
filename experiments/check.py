"""`groundwalk check`: what recordings can show, before anything is fitted."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from diagnosis.check import check
from diagnosis.check.result import Check
from diagnosis.traces.trace import DriveBy
from experiments.check_report.console import print_check
from experiments.check_report.page import write_page
from experiments.command_line import run_verb
from experiments.diagnose import Diagnose, read_all, with_model
from experiments.planned_files import write_planned
from experiments.reports.report import REPORT
from experiments.reports.tables import print_folder
from experiments.runs.extras import extra
from experiments.runs.folder import RESULT, RunFolder, check_free
from groundwalk.errors import BadRecordingError, BadValueError

VERB = "check"
NEXT = "next"
"""Name of the folder, in a run's folder, of the motions to record next."""


@dataclass(frozen=True)
class CheckRecordings:
    """Find out in seconds what recordings can show, and what to record next.

    Nothing is fitted. Rate, noise and defects are measured; for each effect at each
    place the smallest size is computed that these recordings would tell.

    Attributes:
      recordings: Parquet or CSV files (docs/recordings.md), or folders of them.
      robot: name of a robot, a model file (.xml or .urdf), or a robot of
        example-robot-data; by default the model that the recordings state.
      reference: recordings of the same robot while it was healthy.
      reference_robot: model of the robot as it was then, if it has another one now.
      servo: type of all servos, such as sts3215@7.4V,P=16, for recordings that do not
        state it; `groundwalk list servos` shows the types.
      kp: stiffness of all servos [N m/rad], for recordings that do not state it.
      kd: damping of all servos [N m s/rad], for recordings that do not state it.
      max_torque: torque limit of all servos [N m], for recordings that do not state it.
      drive: what moves the model's joints where both commands and torques were
        recorded: its servos, or the measured torques.
      max_speed: highest speed of proposed motions [rad/s]; by default what the model
        states, or 5 rad/s.
      threads: processor threads of the simulations.
      out: folder for a page and for the motions to record next; none by default.
      json: print the result as JSON.

    Example:
      >>> CheckRecordings((Path("a.parquet"),), "so101").max_speed
    """

    recordings: Annotated[
        tuple[Path, ...], tyro.conf.Positional, tyro.conf.arg(metavar="RECORDING...")
    ] = ()
    robot: str = ""
    reference: Annotated[tuple[Path, ...], tyro.conf.arg(metavar="RECORDING...")] = ()
    reference_robot: str = ""
    servo: str = ""
    kp: float | None = None
    kd: float | None = None
    max_torque: float | None = None
    drive: DriveBy = "servos"
    max_speed: float | None = None
    threads: int = 2
    out: Path | None = None
    json: bool = False

    def __post_init__(self) -> None:
        """Refuse invalid options before anything is read."""
        _ = self.asked  # options are those of a diagnosis
        if self.max_speed is not None and not self.max_speed > 0:
            raise BadValueError(f"max_speed is {self.max_speed}; it must be above 0")

    @property
    def asked(self) -> Diagnose:
        """The options with which these recordings would be diagnosed."""
        return Diagnose(
            self.recordings,
            self.robot,
            self.reference,
            self.reference_robot,
            servo=self.servo,
            kp=self.kp,
            kd=self.kd,
            max_torque=self.max_torque,
            drive=self.drive,
            threads=self.threads,
        )


def main(config: CheckRecordings) -> None:
    """Check the recordings, and print the result; write it if asked to."""
    found = check_recordings(config)
    if config.json:
        print(json.dumps(found.to_plain(), indent=1))
    else:
        print_check(found, config.out is not None)
    if config.out is not None:
        folder = write_check(config, found)
        if not config.json:
            print_folder(folder.path)
    if not found.usable:
        raise BadRecordingError("these recordings cannot be diagnosed, see above")


def check_recordings(config: CheckRecordings) -> Check:
    """Check recordings; nothing is written.

    Example:
      >>> check_recordings(CheckRecordings((Path("a.parquet"),))).usable
      True
    """
    check_free(config.out)
    plant, traces, reference = read_all(with_model(config.asked))
    own = reference, config.drive, config.threads, config.max_speed
    return check(plant, traces, *own)


def write_check(config: CheckRecordings, found: Check) -> RunFolder:
    """Write result, page, and the motions to record next into a new run folder."""
    folder = RunFolder.create(VERB, config)
    folder.write_text(RESULT, json.dumps(found.to_plain(), indent=1) + "\n")
    write_planned(folder.path / NEXT, [one.planned for one in found.proposed])
    with extra(REPORT):
        write_page(folder, found)
    return folder


if __name__ == "__main__":
    run_verb(CheckRecordings, main)
