"""`groundwalk check`: what recordings can show, before anything is fitted."""

import json
from dataclasses import dataclass
from pathlib import Path

from diagnosis.check import check
from diagnosis.check.result import Check
from experiments.check_report.console import print_check
from experiments.check_report.page import write_page
from experiments.command_line import run_verb
from experiments.planned_files import write_planned
from experiments.reports.report import REPORT
from experiments.reports.tables import print_folder
from experiments.runs.extras import extra
from experiments.runs.folder import RESULT, RunFolder, check_free
from experiments.runs.recording_options import RecordingOptions, read_all, with_model
from groundwalk.errors import BadRecordingError, BadValueError

VERB = "check"
NEXT = "next"
"""Name of the folder, in a run's folder, of the motions to record next."""


@dataclass(frozen=True)
class CheckRecordings(RecordingOptions):
    """Find out in seconds what recordings can show, and what to record next.

    Nothing is fitted. Rate, noise and defects are measured; for each effect at each
    place the smallest size is computed that these recordings would tell.

    Attributes:
      max_speed: highest speed of proposed motions [rad/s]; by default what the model
        states, or 5 rad/s.
      out: folder for a page and for the motions to record next; none by default.
      json: print the result as JSON.

    Example:
      >>> CheckRecordings((Path("a.parquet"),), "so101").max_speed
    """

    max_speed: float | None = None
    out: Path | None = None
    json: bool = False

    def __post_init__(self) -> None:
        """Refuse invalid options before anything is read."""
        super().__post_init__()
        self.check_given()
        if self.max_speed is not None and not self.max_speed > 0:
            raise BadValueError(f"max_speed is {self.max_speed}; it must be above 0")


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
    plant, traces, reference = read_all(with_model(config))
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
