"""Baselines: established methods that answer the same question as a diagnosis.

Each is a function `answer(plant, traces, reference)` of the nominal robot model, of the
recordings that a diagnosis would fit, and of those of the healthy robot, if any. Its
verdict can be scored like that of a diagnosis.
"""

from collections.abc import Callable, Mapping, Sequence

from diagnosis.baselines import bic, ebic, sparse, sysid
from diagnosis.plant.plant import Plant
from diagnosis.traces.reference import Reference
from diagnosis.traces.trace import Trace
from diagnosis.verdict import Verdict

__all__ = ["BASELINES"]

Baseline = Callable[[Plant, Sequence[Trace], Reference | None], Verdict]

BASELINES: Mapping[str, Baseline] = {
    "sysid": sysid.answer,
    "bic": bic.answer,
    "ebic": ebic.answer,
    "sparse": sparse.answer,
}
"""Simple ways to make a verdict from a robot model and recordings, by name, with which
the diagnosis is compared. Sets of test cases keep answers in folders of these names.

Example:
  >>> verdict = BASELINES["sparse"](plant, traces, [])
"""
