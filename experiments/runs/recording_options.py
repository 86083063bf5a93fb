"""Options of the verbs that read recordings of one robot, and what they read."""

import sys
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, TypeVar

import tyro

from diagnosis import Plant, Reference, Trace, read_reference, read_traces
from diagnosis.traces.trace import DriveBy
from experiments.runs.options import check_at_least
from experiments.runs.robot_model import model_note, robot_model
from experiments.runs.servo_options import servo_gains
from groundwalk.errors import BadValueError
from worlds import ServoGains


@dataclass(frozen=True)
class RecordingOptions:
    """Recordings of a robot, its model, its servos, and what moves its joints.

    Attributes:
      recordings: Parquet or CSV files (docs/recordings.md), or folders of them.
      robot: name of a robot, a model file (.xml or .urdf), or a robot of
        example-robot-data; by default the model that the recordings state.
      reference: recordings of the same robot while it was healthy. What they show is
        taken as given; the question is then what has changed since.
      reference_robot: model of the robot as it was then, if it has another tool or
        another model now; in the form of `robot`.
      servo: type of all servos, supply and position gain, such as sts3215@7.4V,P=16,
        for recordings that do not state it; `groundwalk list servos` shows the types.
      kp: stiffness of all servos [N m/rad], for recordings that do not state it.
      kd: damping of all servos [N m s/rad], for recordings that do not state it.
      max_torque: torque limit of all servos [N m], for recordings that do not state it;
        no limit by default.
      drive: what moves the model's joints where both commands and torques were
        recorded: its servos, or the measured torques.
      threads: processor threads of the replays.

    Example:
      >>> RecordingOptions((Path("a.parquet"),), kp=8.0).gains.kp
      8.0
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
    threads: int = 2

    def __post_init__(self) -> None:
        """Refuse invalid options before anything is read."""
        if self.reference_robot and not self.reference:
            raise BadValueError("reference_robot is given without a reference")
        _ = self.gains  # wrong values are refused
        check_at_least(self, threads=0)

    @property
    def gains(self) -> ServoGains | None:
        """The gains that --servo, or --kp, --kd and --max-torque, give; or None."""
        return servo_gains(self.kp, self.kd, self.max_torque, self.servo)

    def check_given(self) -> None:
        """Refuse options without a recording."""
        if not self.recordings:
            raise BadValueError("no recording is given; give one at least")


Options = TypeVar("Options", bound=RecordingOptions)


def with_model(options: Options) -> Options:
    """The options with the model to use; says if it is another than recordings state.

    Raises:
      BadRecordingError: no model is given, and there is none that recordings state.

    Example:
      >>> with_model(RecordingOptions((Path("a.parquet"),))).robot
      'a.nominal.urdf'
    """
    robot = robot_model(options.recordings, options.robot)
    note = model_note(options.recordings, robot)
    if note:
        print(f"note: {note}", file=sys.stderr)
    return replace(options, robot=robot)


Read = tuple[Plant, list[Trace], Reference | None]
"""The robot model, the recordings, and the reference recordings (healthy robot)."""


def read_all(options: RecordingOptions) -> Read:
    """Read the robot model, its recordings and the reference recordings.

    Example:
      >>> plant, traces, reference = read_all(with_model(options))
    """
    plant, traces = read_traces(options.recordings, options.robot, options.gains)
    then = options.reference_robot or options.robot
    reference = read_reference(options.reference, then, plant, options.gains)
    return plant, traces, reference
