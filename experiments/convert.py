"""`groundwalk convert`: recordings from files that robots and other programs write."""

import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Annotated, Literal

import tyro

from experiments.command_line import run_verb
from experiments.reports.tables import print_table
from experiments.runs.folder import check_new
from experiments.runs.load_options import known_loads
from experiments.runs.servo_options import servo_gains
from groundwalk.errors import (
    BadRecordingError,
    BadValueError,
    ForeignFileError,
    nearest_name,
)
from worlds import Load, Recording, RecordingMetadata, ServoGains
from worlds.foreign import (
    BagOptions,
    ForeignRecording,
    Kind,
    LeRobotOptions,
    kind_of,
    sources_in,
)
from worlds.foreign.bag_recording import Clock, read_bag
from worlds.foreign.bam import read_bam
from worlds.foreign.lerobot import read_lerobot
from worlds.foreign.mapping import Entry, apply, plan, unused
from worlds.foreign.pace import read_pace
from worlds.foreign.tables import ForeignTable, read_table
from worlds.recordings.many import write_recordings

Words = Annotated[tuple[tuple[str, ...], ...], tyro.conf.UseAppendAction]
"""Type of an option that takes several words, and may be given several times."""

FOR_KINDS: dict[str, tuple[Kind, ...]] = {
    "map": ("table",),
    "yes": ("table",),
    "joints": ("table", "bag", "bam", "pace"),
    "state_topic": ("bag",),
    "command_topic": ("bag",),
    "effort_topic": ("bag",),
    "clock": ("bag",),
    "unit": ("lerobot",),
    "calibration": ("lerobot",),
}
"""The kinds of sources for which an option means something."""

_NO_ROBOT = "unknown"


@dataclass(frozen=True)
class Convert:
    """Make recordings (docs/recordings.md) from files of other programs.

    Sources are CSV tables, ROS 2 bags (.db3, .mcap or their folder), folders of LeRobot
    data sets, logs of BAM (.json) and data of PACE (.npz).

    Attributes:
      sources: the files and folders; of a folder that is no bag or data set itself all
        files are taken whose kind is known.
      out: the file to write, .parquet or .csv; or a folder for all recordings.
      format: kind of the files in a folder.
      robot: name of the robot or its model file, whose joints the recording must have.
      rename: new names of joints, old=new; `fer_*=panda_*` renames many.
      joints: names of joints that the source only numbers, in their order.
      without: joints that are left out.
      base: how the robot's base is held.
      servo: type of all servos, supply and position gain, such as sts3215@7.4V,P=16;
        `groundwalk list servos` shows the types.
      kp: stiffness of all servos [N m/rad].
      kd: damping of all servos [N m s/rad].
      max_torque: torque limit of all servos [N m].
      load: a known mass [kg] that a body carried, and where in the body's frame it is
        fixed [m], such as lever=1.02@0,0,-0.15.
      source: where the recording comes from; by default what the file tells.
      map: what the columns of a table are, such as position.elbow=q2*deg or time=t*ms;
        `none` in place of a column leaves one out.
      yes: take what was guessed about a table.
      state_topic: topic of a bag with the measured positions.
      command_topic: topic of a bag with the commands, or none.
      effort_topic: topic of a bag with measured torques, or none.
      clock: times of a bag's rows: of the messages' headers, or of their receipt.
      unit: unit of a LeRobot data set: deg, rad or percent; joint=unit for one joint.
      calibration: LeRobot's calibration file, which percent needs.

    Example:
      >>> convert(Convert((Path("arm.mcap"),), out=Path("arm.parquet")))
    """

    sources: Annotated[
        tuple[Path, ...], tyro.conf.Positional, tyro.conf.arg(metavar="SOURCE...")
    ]
    out: Path
    format: Literal["parquet", "csv"] = "parquet"
    robot: str = ""
    rename: Words = ()
    joints: Words = ()
    without: Words = ()
    base: Literal["fixed", "floating"] = "fixed"
    servo: str = ""
    kp: float | None = None
    kd: float | None = None
    max_torque: float | None = None
    load: Words = ()
    source: str = ""
    map: Words = ()
    yes: bool = False
    state_topic: str = ""
    command_topic: str = ""
    effort_topic: str = ""
    clock: Clock = "auto"
    unit: Words = ()
    calibration: Path | None = None

    def __post_init__(self) -> None:
        """Refuse invalid options before anything is read."""
        if not self.sources:
            raise BadValueError("no source is given; give one file or folder at least")
        if self.is_file:
            check_new(self.out)
        elif self.out.suffix or self.out.is_file():
            raise BadValueError(
                f"out is {self.out}; give a .parquet, a .csv or a folder"
            )
        kinds = {kind_of(source) for source in self.every_source}
        for option, meant_for in FOR_KINDS.items():
            given = (
                getattr(self, option) != type(self).__dataclass_fields__[option].default
            )
            if given and kinds.isdisjoint(meant_for):
                raise BadValueError(
                    f"{option.replace('_', '-')} is given, but no source is a "
                    f"{' or '.join(meant_for)}"
                )
        _ = self.gains, self.new_names, self.loads  # they refuse wrong values

    @property
    def every_source(self) -> list[Path]:
        """The sources, with those in a folder that is none itself."""
        return list(chain.from_iterable(map(sources_in, self.sources)))

    @property
    def is_file(self) -> bool:
        """Whether one file is written, not a folder."""
        return self.out.suffix.lower() in (".parquet", ".csv")

    @property
    def gains(self) -> ServoGains | None:
        """The gains of all servos; None if they are not given."""
        return servo_gains(self.kp, self.kd, self.max_torque, self.servo)

    @property
    def loads(self) -> dict[str, Load]:
        """The known loads by the body's name."""
        return known_loads(_flat(self.load))

    @property
    def new_names(self) -> dict[str, str]:
        """New names of joints by old ones."""
        pairs = {}
        for text in _flat(self.rename):
            old, equals, new = (part.strip() for part in text.partition("="))
            if not (old and equals and new) or max(old.count("*"), new.count("*")) > 1:
                raise BadValueError(f"rename is {text!r}; it must be like old=new")
            pairs[old] = new
        return pairs


def main(config: Convert) -> None:
    """Convert, and print what was written."""
    for path, recording in convert(config).items():
        quantities = dict.fromkeys(name.partition(".")[0] for name in recording.columns)
        print(
            f"wrote {path}: {recording.ticks} rows, {recording.duration_s:.4g} s, "
            f"joints {', '.join(recording.joints)}; {', '.join(quantities)}"
        )


def convert(config: Convert) -> dict[Path, Recording]:
    """Read the sources, write the recordings, and return them by their paths.

    Tables whose meaning was guessed, and what else was chosen, are printed.

    Raises:
      GroundwalkError: a source cannot be read, is ambiguous, or a file exists already;
        nothing is written then.
    """
    shown: set[tuple[object, ...]] = set()
    every = (_read(config, one, shown) for one in config.every_source)
    found = list(chain.from_iterable(every))
    named = [one.renamed(config.new_names) for one in found]
    recordings = dict(
        zip(
            _paths(config, named),
            (_recording(config, one) for one in named),
            strict=True,
        )
    )
    for note in dict.fromkeys(chain.from_iterable(one.notes for one in named)):
        print(note)
    write_recordings(recordings)
    return recordings


def _read(
    config: Convert, source: Path, shown: set[tuple[object, ...]]
) -> list[ForeignRecording]:
    """The recordings in a source, without joints that are not wanted.

    Guesses that were `shown` for another source are not shown again.
    """
    kind, joints, without = kind_of(source), _flat(config.joints), _flat(config.without)
    if kind == "lerobot":
        options = LeRobotOptions(_flat(config.unit), config.calibration, without)
        return read_lerobot(source, options)
    if kind == "bag":
        topics = (config.state_topic, config.command_topic, config.effort_topic)
        found = [read_bag(source, BagOptions(*topics, joints, config.clock))]
    elif kind == "table":
        found = [_from_table(config, read_table(source), shown)]
    else:
        found = read_bam(source) if kind == "bam" else [read_pace(source)]
    if joints and kind != "bag":  # there they are those of a topic without names
        found = [one.numbered(joints) for one in found]
    return [one.without(without) for one in found]


def _from_table(
    config: Convert, table: ForeignTable, shown: set[tuple[object, ...]]
) -> ForeignRecording:
    """The recording in a table, after the user has seen what was guessed."""
    entries = plan(table, _flat(config.map))
    if any(one.guessed for one in entries):
        same = *entries, *unused(table, entries)
        if same not in shown:
            _show(table, entries)
        shown.add(same)
        if not config.yes:
            raise ForeignFileError(
                f"{table.path}: nothing is written, as this was guessed: take it with "
                "--yes, or correct it, as with --map "
                f"{entries[-1].column}={entries[-1].source}*{entries[-1].unit}"
            )
    return apply(table, entries)


def _show(table: ForeignTable, entries: Sequence[Entry]) -> None:
    print_table(
        ["recording", "column", "unit", "known from"],
        [[one.column, one.source, one.unit, one.reason] for one in entries],
    )
    if left := unused(table, entries):
        print(f"not used: {', '.join(left)}")


def _recording(config: Convert, found: ForeignRecording) -> Recording:
    gains = config.gains
    if config.robot:
        _check_names(config, found)
    metadata = RecordingMetadata(
        robot=_robot(config) or found.robot or _NO_ROBOT,
        base=config.base,
        source=config.source or f"groundwalk convert: {found.source}",
        servo=dict.fromkeys(found.joints, gains) if gains is not None else {},
        loads=config.loads,
    )
    try:
        return found.recording(metadata)
    except BadRecordingError as error:
        raise ForeignFileError(f"{found.name}: {error}") from error


def _robot(config: Convert) -> str:
    """The robot's name, or the path from the recording's folder to its model."""
    if not Path(config.robot).suffix:
        return config.robot
    folder = config.out.parent if config.is_file else config.out
    return os.path.relpath(config.robot, folder)


def _check_names(config: Convert, found: ForeignRecording) -> None:
    from diagnosis.plant.load import load_plant
    from diagnosis.plant.loads import check_loads

    plant = load_plant(config.robot, config.base)
    check_loads(config.loads, plant, found.name)
    known = plant.joints
    for joint in found.joints:
        if joint not in known:
            close = nearest_name(joint, known) or known[0]
            raise ForeignFileError(
                f"{found.name}: {config.robot} has no joint {joint!r}; it has "
                f"{', '.join(known)}: give --rename {joint}={close}, or --without "
                f"{joint}"
            )


def _paths(config: Convert, found: Sequence[ForeignRecording]) -> list[Path]:
    """Where each recording goes."""
    if config.is_file:
        if len(found) > 1:
            raise BadValueError(
                f"the sources hold {len(found)} recordings: give a folder with --out"
            )
        return [config.out]
    names = [one.name for one in found]
    twice = [name for name in names if names.count(name) > 1]
    if twice:
        raise BadValueError(f"two recordings would be called {twice[0]}")
    return [config.out / f"{name}.{config.format}" for name in names]


def _flat(words: Iterable[Iterable[str]]) -> tuple[str, ...]:
    return tuple(chain.from_iterable(words))


if __name__ == "__main__":
    run_verb(Convert, main)
