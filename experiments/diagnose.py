"""`groundwalk diagnose`: find the physics that recordings show and the sim lacks."""

import shutil
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import numpy as np
import tyro

import robots
from diagnosis import (
    Diagnosis,
    Hooks,
    Plant,
    Reference,
    Rules,
    Trace,
    Verdict,
    diagnose,
    read_reference,
    read_traces,
)
from diagnosis.seen import Seen
from diagnosis.traces.time_line import time_line
from diagnosis.traces.trace import DriveBy
from experiments.command_line import run_verb
from experiments.diagnosis_report.console import print_verdict
from experiments.diagnosis_report.corrected_files import FILES, write_correction
from experiments.diagnosis_report.joints_shown import look_at
from experiments.diagnosis_report.overlay import write_overlay
from experiments.diagnosis_report.page import ReportFacts, write_report
from experiments.diagnosis_report.text import badge
from experiments.reports.origin import command_of, shown
from experiments.runs.checkpoint_files import CheckpointFiles
from experiments.runs.extras import extra
from experiments.runs.folder import (
    CONFIG,
    PROVENANCE,
    RunFolder,
    check_free,
    open_run,
    to_plain,
)
from experiments.runs.options import RunOptions, check_at_least
from experiments.runs.progress import Stages
from experiments.runs.robot_model import model_note, robot_model
from experiments.runs.servo_options import servo_gains
from groundwalk.errors import BadRecordingError, BadValueError, GroundwalkError
from worlds import ServoGains

VERB = "diagnose"
_NO_SETTINGS = ("recordings", "out", "resume", "json")
VERDICT, REPORT, OVERLAY, AUDIT, SEEN = (
    "diagnosis.json", "report.html", "overlay.rrd", "audit.json", "seen.json",
)  # fmt: skip
STAGES = "stages"
"""Name of a run's folder of intermediate results, deleted when the run is complete."""


@dataclass(frozen=True)
class Diagnose(RunOptions):
    """Find out what physics a sim lacks, from recordings of the robot.

    Attributes:
      recordings: Parquet or CSV files (docs/recordings.md), or folders of them.
      reference: recordings of the same robot while it was healthy. What they show is
        taken as given; the question is then what has changed since.
      reference_robot: model of the robot as it was then, if it has another tool or
        another model now; in the form of `robot`.
      robot: name of a robot, a model file (.xml or .urdf), or a robot of
        example-robot-data; by default the model that the recordings state.
      servo: type of all servos, supply and position gain, such as sts3215@7.4V,P=16,
        for recordings that do not state it; `groundwalk list servos` shows the types.
      kp: stiffness of all servos [N m/rad], for recordings that do not state it.
      kd: damping of all servos [N m s/rad], for recordings that do not state it.
      max_torque: torque limit of all servos [N m], for recordings that do not state it;
        no limit by default.
      drive: what moves the model's joints where both commands and torques were
        recorded: its servos, or the measured torques.
      least_share: smallest share of the sim's squared error that an effect must explain
        to be reported, from 0 to below 1.
      threads: processor threads of the replays.

    Example:
      See docs/python.md, "Diagnose your own recording".
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
    least_share: float = Rules.least_share
    threads: int = 2

    def __post_init__(self) -> None:
        """Refuse invalid options before anything is written."""
        super().__post_init__()
        if self.resume is None and not self.recordings:
            raise BadValueError("no recording is given; give one at least")
        if self.reference_robot and not self.reference:
            raise BadValueError("reference_robot is given without a reference")
        _ = self.gains  # wrong values are refused
        if not 0 <= self.least_share < 1:
            raise BadValueError(
                f"least_share is {self.least_share}; it must be at least 0, below 1"
            )
        check_at_least(self, threads=0)

    @property
    def gains(self) -> ServoGains | None:
        """The gains that --servo, or --kp, --kd and --max-torque, give; or None."""
        return servo_gains(self.kp, self.kd, self.max_torque, self.servo)


def main(config: Diagnose) -> None:
    """Diagnose and print the verdict."""
    folder, verdict = run_diagnosis(config)
    if config.json:
        print(verdict.to_json(), end="")
    else:
        written = [folder.path / name for name in (REPORT, OVERLAY)]
        paths = [path for path in written if path.exists()]
        asked = folder.read_json(CONFIG)  # a resumed run has no options of its own
        print_verdict(verdict, paths, changed=bool(asked["reference"]))


def run_diagnosis(config: Diagnose) -> tuple[RunFolder, Verdict]:
    """Diagnose, and write verdict, report and Rerun overlay into the run folder.

    An interrupted run continues after its last finished stage if `config.resume` names
    its folder; the verdict is then the same to the last digit, except for its duration.

    Example:
      >>> folder, verdict = run_diagnosis(Diagnose((Path("a.parquet"),), robot="nao"))
    """
    check_free(config.out)
    # recordings that cannot be read are refused before a folder is made
    config = with_model(config)
    read = None if config.resume else read_all(config)
    folder, config = open_run(VERB, config)
    checkpoint = CheckpointFiles(folder.path / STAGES)
    if folder.has(VERDICT) and not checkpoint.exists():
        return folder, Verdict.from_json((folder.path / VERDICT).read_text())
    with Stages("diagnosis", config.threads) as stages:
        hooks = Hooks(stages, checkpoint)
        read = read or read_all(config)
        found = _diagnosed(config, read, folder, hooks)
        stages.stage("report", 3)
        _write(config, folder, found, read[1], stages.advance)
    checkpoint.delete()
    return folder, found.verdict


def with_model(config: Diagnose) -> Diagnose:
    """The options with the model to use; says if it is another than recordings state.

    A resumed run has its own model.
    """
    if config.resume is not None:
        return config
    robot = robot_model(config.recordings, config.robot)
    note = model_note(config.recordings, robot)
    if note:
        print(f"note: {note}", file=sys.stderr)
    return replace(config, robot=robot)


Read = tuple[Plant, list[Trace], Reference | None]
"""The robot model, the recordings, and the reference recordings (healthy robot)."""


def read_all(config: Diagnose) -> Read:
    """Read the robot model, its recordings and the reference recordings."""
    plant, traces = read_traces(config.recordings, config.robot, config.gains)
    then = config.reference_robot or config.robot
    reference = read_reference(config.reference, then, plant, config.gains)
    return plant, traces, reference


def _diagnosed(
    config: Diagnose, read: Read, folder: RunFolder, hooks: Hooks
) -> Diagnosis:
    """Diagnose; delete the run's folder if its recordings are refused."""
    plant, traces, reference = read
    try:
        return diagnose(
            plant,
            traces,
            np.random.SeedSequence(config.seed),
            Rules(least_share=config.least_share),
            config.threads,
            reference,
            config.drive,
            hooks,
        )
    except BadRecordingError:
        if config.resume is None:
            shutil.rmtree(folder.path)
        raise


def _write(
    config: Diagnose,
    folder: RunFolder,
    found: Diagnosis,
    traces: Sequence[Trace],
    advance: Callable[[], None],
) -> None:
    """Write the verdict, then the report and the other files that explain it."""
    folder.write_text(VERDICT, found.verdict.to_json())
    folder.write_text(AUDIT, found.audit.to_json() + "\n")
    write_correction(folder, found)
    advance()
    series = found.held_out()
    seen: Seen | None = None
    with extra(SEEN):
        seen = look_at(found, traces)
        folder.write_text(SEEN, seen.to_json())
    own = found.verdict.pulses, found.verdict.effects
    told = time_line(found.plant.joints, traces, found.parts, *own)
    with extra(REPORT):
        facts = _facts(config, folder, found)
        write_report(folder.path / REPORT, found.verdict, series, facts, seen, told)
    advance()
    with extra(OVERLAY):
        fit, words = found.verdict.fit, badge(found.verdict, bool(config.reference))
        about = fit, _description(config), told, words
        write_overlay(folder.path / OVERLAY, series, *about)
    advance()


def _description(config: Diagnose) -> robots.Description | None:
    """The robot that the Rerun overlay draws; None if it is no biped."""
    try:
        return robots.get(config.robot)
    except GroundwalkError:
        return None


def _facts(config: Diagnose, folder: RunFolder, found: Diagnosis) -> ReportFacts:
    provenance = folder.read_json(PROVENANCE)
    settings = {
        name: str(value)
        for name, value in to_plain(config).items()
        if value is not None and name not in _NO_SETTINGS
    }
    files = {
        VERDICT: "the verdict, for programs",
        OVERLAY: "real, sim and corrected sim in Rerun",
        AUDIT: "rate, noise and defects of the recordings",
        SEEN: "what each joint shows, before any effect is named",
    }
    files |= {name: what for name, what in FILES.items() if folder.has(name)}
    packages = {k: str(v) for k, v in provenance["packages"].items() if v}
    return ReportFacts(
        robot=shown(config.robot),
        base=found.plant.base,
        command=command_of(provenance),
        settings=settings,
        versions={"groundwalk": provenance["groundwalk"], **packages},
        files=files,
        changed=bool(config.reference),
    )


if __name__ == "__main__":
    run_verb(Diagnose, main)
