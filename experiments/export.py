"""`groundwalk export`: write a robot's model as a file for MuJoCo or PyBullet."""

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import tyro

import robots
from experiments.command_line import run_verb
from experiments.runs.folder import check_new
from groundwalk.files import write_text
from robots.engine_models.mjcf import mujoco_spec
from robots.engine_models.urdf import urdf


@dataclass(frozen=True)
class Export:
    """Write a robot's model, without any ground, as MJCF or URDF.

    Attributes:
      robot: name of a robot (`groundwalk list robots`), or a .urdf or .toml file.
      format: mjcf for MuJoCo, with motors and sensors; urdf for PyBullet and others.
      out: the file to write; standard output by default.
    """

    robot: Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="ROBOT")]
    format: Literal["mjcf", "urdf"]
    out: Path | None = None

    def __post_init__(self) -> None:
        """Refuse an unknown robot, or an output file that exists."""
        robots.get(self.robot)
        if self.out is not None:
            check_new(self.out)


def main(config: Export) -> None:
    """Write the model to the file, or to standard output."""
    description = robots.get(config.robot)
    if config.format == "urdf":
        text = urdf(description)
    else:
        text = mujoco_spec(description).to_xml()
    if config.out is None:
        sys.stdout.write(text)
    else:
        write_text(config.out, text)


if __name__ == "__main__":
    run_verb(Export, main)
