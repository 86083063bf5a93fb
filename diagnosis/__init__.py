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

if TYPE_CHECKING:  # `as` says that a name is public
    from diagnosis.effects.effect import Effect as Effect
    from diagnosis.effects.library import all_effects as all_effects
    from diagnosis.effects.library import also_known as also_known
    from diagnosis.effects.library import effect as effect
    from diagnosis.effects.parts import Parameter as Parameter
    from diagnosis.effects.parts import PlacedEffect as PlacedEffect
    from diagnosis.pipeline import Diagnosis as Diagnosis
    from diagnosis.pipeline import diagnose as diagnose
    from diagnosis.plant.load import load_plant as load_plant
    from diagnosis.plant.plant import Plant as Plant
    from diagnosis.prediction import Prediction as Prediction
    from diagnosis.prediction import predict as predict
    from diagnosis.search.hooks import Hooks as Hooks
    from diagnosis.search.rules import Rules as Rules
    from diagnosis.traces.read import read_reference as read_reference
    from diagnosis.traces.read import read_traces as read_traces
    from diagnosis.traces.reference import Reference as Reference
    from diagnosis.traces.trace import Trace as Trace
    from diagnosis.verdict.verdict import Verdict as Verdict

_HOMES = {
    "effects.effect": ("Effect",),
    "effects.library": ("all_effects", "also_known", "effect"),
    "effects.parts": ("Parameter", "PlacedEffect"),
    "pipeline": ("Diagnosis", "diagnose"),
    "plant.load": ("load_plant",),
    "plant.plant": ("Plant",),
    "prediction": ("Prediction", "predict"),
    "search.hooks": ("Hooks",),
    "search.rules": ("Rules",),
    "traces.read": ("read_reference", "read_traces"),
    "traces.reference": ("Reference",),
    "traces.trace": ("Trace",),
    "verdict.verdict": ("Verdict",),
}
__all__ = [name for names in _HOMES.values() for name in names]
__getattr__ = lazy_face(__name__, _HOMES)
