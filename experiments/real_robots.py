"""`groundwalk real-robots`: diagnose real robots, and compare with published values."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import tyro

from diagnosis import Rules
from experiments.command_line import run_verb
from experiments.diagnose import Diagnose, run_diagnosis
from experiments.diagnosis_report.console import print_verdict
from experiments.real_robot_study.cases import ROBOTS
from experiments.real_robot_study.page import write_real_page
from experiments.reports.report import REPORT
from experiments.runs.extras import extra
from groundwalk.errors import BadValueError

DATA = Path("data")
"""Default folder of the real robots' recordings, which are not in the repository."""
DIAGNOSIS = "diagnosis.html"
"""File name of the diagnosis' own report, because `report.html` is the run's page,
which compares the diagnosis with published values."""


@dataclass(frozen=True)
class RealRobots:
    """Diagnose recordings of a real robot, and compare with published values.

    Attributes:
      robot: the robot whose recordings are diagnosed.
      data: folder with a subfolder of recordings for each robot; docs/diagnosis.md says
        where they come from.
      seed: every random number follows from it.
      threads: processor threads of the replays.
      out: the run's folder; a new one under runs/ by default.
    """

    robot: Annotated[Literal["so101", "emps", "go2"], tyro.conf.Positional]
    data: Path = DATA
    seed: int = 1
    threads: int = 2
    out: Path | None = None

    def diagnose(self) -> Diagnose:
        """The options of `groundwalk diagnose` for this robot's recordings."""
        case = ROBOTS[self.robot]
        folder = self.data / case.folder
        recordings = tuple(sorted(folder.glob("*.parquet")))
        if not recordings:
            raise BadValueError(
                f"{folder} has no recordings: give the folder that holds "
                f"{case.folder}/ with --data; they come from {case.source}"
            )
        gains, share = case.gains, case.least_share
        return Diagnose(
            recordings,
            str(folder / case.model) if Path(case.model).suffix else case.model,
            kp=None if gains is None else gains.kp,
            kd=None if gains is None else gains.kd,
            max_torque=None if gains is None else gains.max_torque,
            drive=case.drive,
            least_share=Rules.least_share if share is None else share,
            seed=self.seed,
            threads=self.threads,
            out=self.out,
        )


def main(config: RealRobots) -> None:
    """Diagnose the robot, write the report page, and print the verdict."""
    folder, verdict = run_diagnosis(config.diagnose())
    report, diagnosis = folder.path / REPORT, folder.path / DIAGNOSIS
    if report.exists():
        report.rename(diagnosis)
    with extra(REPORT):
        write_real_page(folder, ROBOTS[config.robot], verdict)
    print_verdict(verdict, [path for path in (report, diagnosis) if path.exists()])


if __name__ == "__main__":
    run_verb(RealRobots, main)
