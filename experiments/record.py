"""`groundwalk record`: record a robot that moves in the sim or in the real world."""

import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from diagnosis import load_plant
from diagnosis.motions.plan import Limits, PlannedMotion, planned
from experiments.check_report.words import CAREFUL
from experiments.command_line import run_verb
from experiments.concealed.motion import FLOATING_STEP_S, STEP_S, motion_feed
from experiments.motions import MOTIONS
from experiments.planned_files import read_planned, write_planned
from experiments.runs.folder import check_new
from experiments.runs.load_options import known_loads
from experiments.runs.options import check_at_least
from experiments.runs.servo_options import servo_gains
from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError, GroundwalkError
from groundwalk.files import write_text
from worlds import Load, Recording
from worlds.hidden.effects import Hidden
from worlds.hidden.plant import HiddenPlant, hidden_plant
from worlds.hidden.recorded import HiddenSensors, hidden_recording
from worlds.hidden.run import Clock, Feed, run_hidden
from worlds.recordings.files import write_recording
from worlds.recordings.metadata import RecordingMetadata

ENGINES = {"sim": "mujoco", "real": "bullet"}
"""Physics engine of each world."""

_RATE_HZ = 100.0
_JITTER_S = 0.0005
"""Standard deviation of the errors of a recording's time stamps [s]."""

_LONGEST_S = 600.0
OWN_MODELS = ("pendulum", "so101")
"""Robots whose model, with servos, is made here instead of read from a file."""

Motion = Literal[
    "chirp", "multisine", "steps", "ramps", "squat", "fast_squat", "sway", "walk"
]


@dataclass(frozen=True)
class Record:
    """Make a recording of a moving robot, in the sim or in the real world.

    The base of the robot is fixed in the air for chirp, multisine, steps and ramps. For
    squats, sway and walks the robot stands on its feet. With --plan nothing is
    recorded: motions are written that a real robot with a fixed base can play.

    Attributes:
      out: the file to write, .parquet or .csv; with --plan a folder.
      robot: pendulum, so101, or a robot of `groundwalk list robots`.
      world: sim is MuJoCo, real is PyBullet; a robot in the air moves alike in both.
      motion: the motion of the robot.
      base: fixed or floating; by default the one that the motion needs.
      hidden: physics that the model lacks, such as backlash@LKneePitch:gap=0.02 or
        coulomb_friction@LKneePitch:torque=0.2; `groundwalk list effects` shows all.
      duration: length of the recording [s].
      seed: every random number follows from it.
      play: a CSV file of commands to play instead of `motion`, as --plan and
        `groundwalk check` write them.
      plan: write motions that excite all physics and keep the limits of a model: that
        of a robot's name, or of a file (.xml, .urdf).
      servo: with --plan, type of all servos, such as sts3215@7.4V,P=16.
      kp: with --plan, stiffness of all servos [N m/rad], if the model states none.
      kd: with --plan, damping of all servos [N m s/rad].
      max_torque: with --plan, torque limit of all servos [N m].
      max_speed: with --plan, highest speed of all joints [rad/s].
      load: a known mass [kg] that a body carries, and where in the body's frame it is
        fixed [m], such as link=1.02@0,0,-0.15; the recording states it.

    Example:
      >>> Record(Path("air.parquet"), robot="pendulum", duration=2.0).on_feet
      False
    """

    out: Path
    robot: str = "nao"
    world: Literal["sim", "real"] = "real"
    motion: Motion = "multisine"
    base: Literal["fixed", "floating"] | None = None
    hidden: tuple[str, ...] = ()
    duration: float = 10.0
    seed: int = 1
    play: Path | None = None
    plan: bool = False
    servo: str = ""
    kp: float | None = None
    kd: float | None = None
    max_torque: float | None = None
    max_speed: float | None = None
    load: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Refuse invalid options before anything is computed."""
        check_new(self.out)
        gains = servo_gains(self.kp, self.kd, self.max_torque, self.servo)
        if self.plan:
            if self.max_speed is not None and not self.max_speed > 0:
                raise BadValueError(
                    f"max_speed is {self.max_speed}; it must be above 0"
                )
            return
        if gains is not None or self.max_speed is not None:
            raise BadValueError(
                "servo, kp, kd, max_torque and max_speed belong to --plan"
            )
        if self.out.suffix.lower() not in (".parquet", ".csv"):
            raise BadValueError(f"out is {self.out}; a recording is .parquet or .csv")
        if not 0.1 <= self.duration <= _LONGEST_S:
            raise BadValueError(
                f"duration is {self.duration}; from 0.1 to {_LONGEST_S:g} s"
            )
        check_at_least(self, seed=0)
        if self.play is not None and self.on_feet:
            raise BadValueError(f"play and motion {self.motion} exclude each other")
        if self.base is not None and (self.base == "floating") != self.on_feet:
            needs = "floating" if self.on_feet else "fixed"
            raise BadValueError(f"motion {self.motion} needs a {needs} base")
        self.effects()
        self.plant().with_loads(self.loads)

    @property
    def loads(self) -> dict[str, Load]:
        """The known loads by the body's name."""
        return known_loads(self.load)

    @property
    def on_feet(self) -> bool:
        """Whether the robot stands on its feet in this motion, not fixed in the air."""
        return self.motion not in MOTIONS

    def effects(self) -> tuple[Hidden, ...]:
        """The effects that `hidden` describes as text."""
        return tuple(Hidden.parse(text) for text in self.hidden)

    def plant(self) -> HiddenPlant:
        """The robot, its base floating if the motion is on feet, otherwise fixed."""
        return hidden_plant(self.robot, floating=self.on_feet)

    @property
    def model_file(self) -> Path:
        """The file of the robot's nominal model, beside `out`.

        It is written unless the robot is one of `groundwalk list robots`.
        """
        file = self.plant().file
        return self.out.with_name(f"{self.out.stem}.{file[0]}") if file else self.out


def main(config: Record) -> None:
    """Make the recording and print the file's name, or plan motions (--plan)."""
    if config.plan:
        for one in plan_motions(config):
            motion = one.motion
            print(f"{motion.name}.csv: {motion.words}; good for {motion.good_for}")
        print(f"wrote {config.out}; {CAREFUL}")
        return
    recording = make_recording(config)
    plant = config.plant()
    print(f"wrote {config.out}: {recording.ticks} ticks of {plant.name}")
    if plant.file is not None:
        print(f"its model is {config.model_file}, which the recording states")


def plan_motions(config: Record) -> list[PlannedMotion]:
    """Plan motions for the robot's model, and write them into the folder `config.out`.

    Raises:
      BadValueError: no servo's stiffness is known, or no motion keeps the limits.

    Example:
      >>> plan_motions(Record(Path("motions"), robot="nao", plan=True))
    """
    gains = servo_gains(config.kp, config.kd, config.max_torque, config.servo)
    with tempfile.TemporaryDirectory() as folder:
        source: str | Path = config.robot
        if config.robot in OWN_MODELS:
            plant = hidden_plant(config.robot)
            assert plant.file is not None
            source = Path(folder) / plant.file[0]
            write_text(source, plant.file[1])
            known = load_plant(source, "fixed", plant.joints, gains or plant.servo)
        else:
            known = load_plant(source, "fixed", None, gains)
    motions = planned(known, Limits.of(known, most_rad_s=config.max_speed))
    if not motions:
        raise BadValueError(
            f"no motion of {config.robot} keeps its limits, not even a small one: its "
            "servos cannot hold it in the middle of its range; is max_torque right?"
        )
    write_planned(config.out, motions)
    return motions


def make_recording(config: Record) -> Recording:
    """Move a robot, write the recording into `config.out`, and return it.

    GroundwalkError if the robot fell, or its simulation diverged.

    Example:
      >>> make_recording(Record(Path("air.parquet"), robot="pendulum", world="sim"))
    """
    plant, effects = config.plant(), config.effects()
    seed = np.random.SeedSequence(config.seed)
    of_motion, of_clock, of_noise, of_ground = seed.spawn(4)
    rng, duration_s = np.random.default_rng(of_motion), config.duration
    if config.play is None:
        time_s = np.arange(round(duration_s * _RATE_HZ) + 1) / _RATE_HZ
        centre_rad = plant.range_rad.mean(axis=1)
        moves = np.ones(len(plant.joints), bool)
        own = plant, config.motion, time_s, _RATE_HZ, rng, centre_rad, moves
        start_rad, feed = motion_feed(*own)
    else:
        duration_s, start_rad, feed = _played(config.play, plant)
    clock = Clock.drawn(
        FLOATING_STEP_S if plant.floating else STEP_S,
        _RATE_HZ,
        (0.0, duration_s),
        _JITTER_S,
        np.random.default_rng(of_clock),
    )
    loaded = plant.with_loads(config.loads)
    run = run_hidden(
        loaded, effects, ENGINES[config.world], clock, feed, start_rad, of_ground
    )
    if not run.ok:
        raise GroundwalkError(
            "no recording: the robot fell, or its simulation diverged"
        )
    if plant.file is not None:
        write_text(config.model_file, plant.file[1])
    played = config.motion if config.play is None else config.play.stem
    metadata = RecordingMetadata(
        robot=config.robot if plant.file is None else config.model_file.name,
        base="floating" if plant.floating else "fixed",
        source=f"groundwalk record: {played}, seed {config.seed}",
        servo=plant.servo,
        loads=config.loads,
        world=config.world,
    )
    recording = hidden_recording(
        plant, run, effects, HiddenSensors(), np.random.default_rng(of_noise), metadata
    )
    write_recording(recording, config.out)
    return recording


def _played(path: Path, plant: HiddenPlant) -> tuple[float, FloatArray, Feed]:
    """Duration [s], start pose (j,) [rad] and command function of a file to play."""
    time_s, command_rad = read_planned(path, plant.joints)
    duration_s = float(time_s[-1] - time_s[0])
    ticks_s = time_s[0] + np.arange(round(duration_s * _RATE_HZ) + 1) / _RATE_HZ
    rows = np.clip(np.searchsorted(time_s, ticks_s + 1e-6) - 1, 0, None)
    return duration_s, command_rad[0], lambda row, sense: command_rad[rows[row]]


if __name__ == "__main__":
    run_verb(Record, main)
