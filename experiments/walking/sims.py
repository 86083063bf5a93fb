"""Makes the sim, plain or with the effects that a diagnosis has found."""

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
    """Make a sim with one robot on each ground, and a seed of sensor noise for each.

    The effects of the correction, run folder or `corrected.json` of a diagnosis, are
    added to it.

    Raises:
      BadModelError: the correction is no diagnosis of this robot, or the sim cannot
        simulate one of its effects.
      UnknownNameError: the correction names an unknown effect or joint.
    """
    if correction is None:
        return worlds.make("sim", description, grounds, seeds, options)
    model = check_correction(description, options, correction)
    return CorrectedSim(description, grounds, seeds, options, model)


def check_correction(
    description: Description, options: WorldOptions, correction: Path
) -> Model:
    """Check that the sim can simulate the effects of a diagnosis, and return them.

    Raises the errors of `make_sim`.
    """
    plant = sim_plant(description, options)
    model = load_correction(correction, plant)
    sim_variants(plant, model, 1)
    return model
