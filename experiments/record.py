"""`groundwalk record`: record a robot that moves in the sim or in the real world."""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from experiments.command_line import run_verb
from experiments.concealed.motion import FLOATING_STEP_S, STEP_S, motion_feed
from experiments.motions import MOTIONS
from experiments.runs.folder import check_new
from experiments.runs.options import check_at_least
from groundwalk.errors import BadValueError, GroundwalkError
from groundwalk.files import write_text
from worlds import Recording
from worlds.hidden.effects import Hidden
from worlds.hidden.plant import HiddenPlant, hidden_plant
from worlds.hidden.recorded import HiddenSensors, hidden_recording
from worlds.hidden.run import Clock, run_hidden
from worlds.recordings.files import write_recording
from worlds.recordings.metadata import RecordingMetadata

ENGINES = {"sim": "mujoco", "real": "bullet"}
"""Physics engine of each world."""

_RATE_HZ = 100.0
_JITTER_S = 0.0005
"""Standard deviation of the errors of a recording's time stamps [s]."""

_LONGEST_S = 600.0
Motion = Literal[
    "chirp", "multisine", "steps", "ramps", "squat", "fast_squat", "sway", "walk"
]


@dataclass(frozen=True)
class Record:
    """Make a recording of a moving robot, in the sim or in the real world.

    The base of the robot is fixed in the air for chirp, multisine, steps and ramps. For
    squats, sway and walks the robot stands on its feet.

    Attributes:
      out: the file to write, .parquet or .csv.
      robot: pendulum, so101, or a robot of `groundwalk list robots`.
      world: sim is MuJoCo, real is PyBullet; a robot in the air moves alike in both.
      motion: the motion of the robot.
      base: fixed or floating; by default the one that the motion needs.
      hidden: physics that the model lacks, such as backlash@LKneePitch:gap=0.02 or
        coulomb_friction@LKneePitch:torque=0.2; `groundwalk list effects` shows all.
      duration: length of the recording [s].
      seed: every random number follows from it.

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

    def __post_init__(self) -> None:
        """Refuse invalid options before anything is computed."""
        check_new(self.out)
        if self.out.suffix.lower() not in (".parquet", ".csv"):
            raise BadValueError(f"out is {self.out}; a recording is .parquet or .csv")
        if not 0.1 <= self.duration <= _LONGEST_S:
            raise BadValueError(
                f"duration is {self.duration}; from 0.1 to {_LONGEST_S:g} s"
            )
        check_at_least(self, seed=0)
        if self.base is not None and (self.base == "floating") != self.on_feet:
            needs = "floating" if self.on_feet else "fixed"
            raise BadValueError(f"motion {self.motion} needs a {needs} base")
        self.effects()
        self.plant()

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
    """Make the recording, and print the file's name."""
    recording = make_recording(config)
    plant = config.plant()
    print(f"wrote {config.out}: {recording.ticks} ticks of {plant.name}")
    if plant.file is not None:
        print(f"its model is {config.model_file}, which the recording states")


def make_recording(config: Record) -> Recording:
    """Move a robot, write the recording into `config.out`, and return it.

    GroundwalkError if the robot fell, or its simulation diverged.

    Example:
      >>> make_recording(Record(Path("air.parquet"), robot="pendulum", world="sim"))
    """
    plant, effects = config.plant(), config.effects()
    seed = np.random.SeedSequence(config.seed)
    of_motion, of_clock, of_noise, of_ground = seed.spawn(4)
    start_rad, feed = motion_feed(
        plant,
        config.motion,
        np.arange(round(config.duration * _RATE_HZ) + 1) / _RATE_HZ,
        _RATE_HZ,
        np.random.default_rng(of_motion),
        plant.range_rad.mean(axis=1),
        np.ones(len(plant.joints), bool),
    )
    clock = Clock.drawn(
        FLOATING_STEP_S if plant.floating else STEP_S,
        _RATE_HZ,
        (0.0, config.duration),
        _JITTER_S,
        np.random.default_rng(of_clock),
    )
    run = run_hidden(
        plant, effects, ENGINES[config.world], clock, feed, start_rad, of_ground
    )
    if not run.ok:
        raise GroundwalkError(
            "no recording: the robot fell, or its simulation diverged"
        )
    if plant.file is not None:
        write_text(config.model_file, plant.file[1])
    metadata = RecordingMetadata(
        robot=config.robot if plant.file is None else config.model_file.name,
        base="floating" if plant.floating else "fixed",
        source=f"groundwalk record: {config.motion}, seed {config.seed}",
        servo=plant.servo,
        world=config.world,
    )
    recording = hidden_recording(
        plant, run, effects, HiddenSensors(), np.random.default_rng(of_noise), metadata
    )
    write_recording(recording, config.out)
    return recording


if __name__ == "__main__":
    run_verb(Record, main)
