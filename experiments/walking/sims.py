"""The sim as it is, or with what a diagnosis found in it."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

import worlds
from diagnosis.corrected.effects_json import load_correction
from diagnosis.corrected.sim import CorrectedSim, sim_plant, sim_variants
from diagnosis.residuals.predictor import Model
from robots import Description
from terrain import Heightfield
from worlds import World, WorldOptions


def make_sim(
    description: Description,
    grounds: Sequence[Heightfield],
    seeds: Sequence[np.random.SeedSequence],
    options: WorldOptions,
    correction: Path | None = None,
) -> World:
    """A sim with one robot on each ground.

    Args:
      description: the robot.
      grounds: one per robot; give one object n times to share it.
      seeds: one per robot, for its sensor noise.
      options: of the sim.
      correction: folder or file of a diagnosis, whose effects the sim shall have.

    Raises:
      BadModelError: it is no diagnosis of this robot, or a sim cannot have its effects.
      UnknownNameError: it speaks of what is not there.
    """
    if correction is None:
        return worlds.make("sim", description, grounds, seeds, options)
    model = check_correction(description, options, correction)
    return CorrectedSim(description, grounds, seeds, options, model)


def check_correction(
    description: Description, options: WorldOptions, correction: Path
) -> Model:
    """The effects that a sim would have; see `make_sim` for arguments and errors."""
    plant = sim_plant(description, options)
    model = load_correction(correction, plant)
    sim_variants(plant, model, 1)
    return model
