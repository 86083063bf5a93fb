"""Simulations with the effects (missing physics) that a diagnosis has found.

`corrected_mjcf` writes the effects into an MJCF file, `Correction` and
`load_correction` store and read them as JSON, and `CorrectedSim` simulates all of them.
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
