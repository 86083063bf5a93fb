"""Finds out where a simulation differs from recordings, and what physics it lacks.

The public names of this package are imported only when they are first used, so that
`import diagnosis` stays quick.

Example:
  >>> import numpy as np
  >>> from diagnosis import diagnose, read_traces
  >>> plant, traces = read_traces(["a.parquet", "b.parquet"], "nao")
  >>> found = diagnose(plant, traces, np.random.SeedSequence(1))
  >>> print(found.verdict.kind, [one.name for one in found.verdict.effects])
"""

from typing import TYPE_CHECKING

from groundwalk.faces import lazy_face

if TYPE_CHECKING:
    from diagnosis.effects.effect import Effect
    from diagnosis.effects.library import all_effects, also_known, effect
    from diagnosis.effects.parts import Parameter, PlacedEffect
    from diagnosis.pipeline import Diagnosis, diagnose
    from diagnosis.plant.load import load_plant
    from diagnosis.plant.plant import Plant
    from diagnosis.search.hooks import Hooks
    from diagnosis.search.rules import Rules
    from diagnosis.traces.read import read_reference, read_traces
    from diagnosis.traces.trace import Trace
    from diagnosis.verdict.verdict import Verdict

__all__ = [
    "Diagnosis",
    "Effect",
    "Hooks",
    "Parameter",
    "PlacedEffect",
    "Plant",
    "Rules",
    "Trace",
    "Verdict",
    "all_effects",
    "also_known",
    "diagnose",
    "effect",
    "load_plant",
    "read_reference",
    "read_traces",
]

__getattr__ = lazy_face(
    __name__,
    {
        "effects.effect": ("Effect",),
        "effects.library": ("all_effects", "also_known", "effect"),
        "effects.parts": ("Parameter", "PlacedEffect"),
        "pipeline": ("Diagnosis", "diagnose"),
        "plant.load": ("load_plant",),
        "plant.plant": ("Plant",),
        "search.hooks": ("Hooks",),
        "search.rules": ("Rules",),
        "traces.read": ("read_reference", "read_traces"),
        "traces.trace": ("Trace",),
        "verdict.verdict": ("Verdict",),
    },
)
