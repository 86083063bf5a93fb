"""Simulations with the effects that a diagnosis has found.

`corrected_mjcf` writes them into an MJCF file, `Correction` and `load_correction` carry
them as JSON, and `CorrectedSim` is the sim world with all of them.
"""

from diagnosis.corrected.effects_json import Correction, load_correction
from diagnosis.corrected.mjcf import corrected_mjcf
from diagnosis.corrected.sim import CorrectedSim, sim_plant

__all__ = [
    "CorrectedSim",
    "Correction",
    "corrected_mjcf",
    "load_correction",
    "sim_plant",
]
