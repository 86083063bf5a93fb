"""`groundwalk diagnose`: find the physics that recordings show and the sim lacks."""

import shutil
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

import robots
from diagnosis import (
    Diagnosis,
    Hooks,
    Rules,
    Trace,
    Verdict,
    diagnose,
)
from diagnosis.seen import Seen
from diagnosis.traces.time_line import time_line
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
from experiments.runs.options import RunOptions
from experiments.runs.progress import Stages
from experiments.runs.recording_options import (
    Read,
    RecordingOptions,
    read_all,
    with_model,
)
from groundwalk.errors import BadRecordingError, BadValueError, GroundwalkError

VERB = "diagnose"
_NO_SETTINGS = ("recordings", "out", "resume", "json")
VERDICT, REPORT, OVERLAY, AUDIT, SEEN = (
    "diagnosis.json", "report.html", "overlay.rrd", "audit.json", "seen.json",
)  # fmt: skip
STAGES = "stages"
"""Name of a run's folder of intermediate results, deleted when the run is complete."""


@dataclass(frozen=True)
class Diagnose(RecordingOptions, RunOptions):
    """Find out what physics a sim lacks, from recordings of the robot.

    Attributes:
      least_share: smallest share of the sim's squared error that an effect must explain
        to be reported, from 0 to below 1.

    Example:
      See docs/python.md, "Diagnose your own recording".
    """

    least_share: float = Rules.least_share

    def __post_init__(self) -> None:
        """Refuse invalid options before anything is written."""
        RunOptions.__post_init__(self)
        RecordingOptions.__post_init__(self)
        if self.resume is None:
            self.check_given()
        if not 0 <= self.least_share < 1:
            raise BadValueError(
                f"least_share is {self.least_share}; it must be at least 0, below 1"
            )


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
    read: Read | None = None
    if config.resume is None:
        config = with_model(config)
        read = read_all(config)
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
