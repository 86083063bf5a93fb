"""What others would do: plain methods that answer the same question as a diagnosis.

Each is `answer(plant, traces)`: the nominal plant and the recordings that a diagnosis
would fit, and a verdict that can be scored beside the diagnosis' own.
"""

from collections.abc import Callable, Mapping, Sequence

from diagnosis.baselines import bic, sparse, sysid
from diagnosis.plant.plant import Plant
from diagnosis.traces.trace import Trace
from diagnosis.verdict.verdict import Verdict

BASELINES: Mapping[str, Callable[[Plant, Sequence[Trace]], Verdict]] = {
    "sysid": sysid.answer,
    "bic": bic.answer,
    "sparse": sparse.answer,
}
"""By the name of their folder among the answers."""
