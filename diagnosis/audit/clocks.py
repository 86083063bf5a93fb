"""Finds recordings whose clock runs otherwise than those of the healthy robot."""

from collections.abc import Iterator, Sequence

import numpy as np

from diagnosis.audit.result import Finding
from diagnosis.traces.trace import Trace

_LEAST = 0.005
"""Smallest relative difference of the rates that is a finding: a clock that is wrong by
as much changes accelerations by 1 %, less than masses are uncertain."""
_MOST = 0.1
"""Rates that differ by more were chosen: a clock is hardly as wrong as that."""
_BAND = (0.1, 0.9)
"""Quantiles of the times between rows, which must lie apart: rates that a busy computer
happens to reach differ no more than its ticks do."""


def clock_findings(
    traces: Sequence[Trace], healthy: Sequence[Trace]
) -> Iterator[Finding]:
    """Find recordings with rows a little faster or slower than in all healthy ones.

    Crystals keep time to a hundredth of a percent, and rates are chosen in larger
    steps: so either a clock is wrong, and with it all speeds, or times were changed.
    """
    before = [_ticks(trace) for trace in healthy if trace.ticks > 1]
    for trace in traces if before else ():
        low, middle, high = _ticks(trace)
        factors = [middle / one for _, one, _ in before]
        differs = all(_LEAST < abs(factor - 1) < _MOST for factor in factors)
        apart = all(low > most or high < least for least, _, most in before)
        if not (differs and apart):
            continue
        usual_s = float(np.median([one for _, one, _ in before]))
        text = (
            f"{trace.name} has a row every {1e3 * middle:.4g} ms, recordings of the "
            f"healthy robot every {1e3 * usual_s:.4g} ms; is its time wrong by a "
            f"factor of {middle / usual_s:.3f}? (If the rates did differ, write both "
            "at the same one.)"
        )
        yield Finding("refuse", text, trace.name, "time")


def _ticks(trace: Trace) -> tuple[float, float, float]:
    """The low, middle and high time between rows [s]."""
    ticks = np.diff(trace.time_s)
    low, middle, high = np.quantile(ticks, (_BAND[0], 0.5, _BAND[1]))
    return float(low), float(middle), float(high)
