"""Audits the clock of a trace: duration, rate, jitter and gaps."""

from collections.abc import Iterator

import numpy as np

from diagnosis.audit.result import Finding, Severity, TraceAudit
from diagnosis.traces.trace import Trace

_LEAST_S, _LEAST_ROWS = 1.0, 50
"""Shortest recording that can be used: its duration [s] and its number of rows."""
_GAP = 2.5
"""Ticks (times between rows) longer than this many median ticks are gaps."""
_LONG_GAP_S = 0.1
"""Gaps between rows limit conclusions if they are this long [s] or longer."""
_SLOWEST_HZ, _SLOW_HZ = 5.0, 45.0
"""Rows per second below which a recording is unusable, and below which delays, armature
and elasticity cannot be estimated."""
_UNEVEN = 0.1
"""Jitter (standard deviation of the ticks) above this share of a tick is a finding."""


def audit_timing(trace: Trace) -> tuple[TraceAudit, list[Finding]]:
    """Measure rate, jitter and gaps of a trace, and find those that limit its use."""
    ticks = np.diff(trace.time_s)
    if not len(ticks) or (ticks <= 0).any() or not np.isfinite(trace.time_s).all():
        audit = TraceAudit(trace.name, trace.ticks, 0.0, 0.0, 0.0, 0, 0.0)
        return audit, [Finding("refuse", _no_clock(trace), trace.name, "time")]
    tick_s = trace.tick_s
    is_gap = ticks > _GAP * tick_s
    audit = TraceAudit(
        name=trace.name,
        rows=trace.ticks,
        duration_s=trace.duration_s,
        rate_hz=1 / tick_s,
        jitter_s=float(np.std(ticks[~is_gap])),
        gaps=int(is_gap.sum()),
        longest_gap_s=float(ticks[is_gap].max(initial=0.0)),
    )
    found = _findings(audit)
    return audit, [Finding(how, text, audit.name, "time") for how, text in found]


def _no_clock(trace: Trace) -> str:
    """What is wrong with times that do not increase, or with too few of them."""
    backwards = np.flatnonzero(~(np.diff(trace.time_s) > 0))
    if not len(backwards):
        return f"{trace.name} has {trace.ticks} rows; at least {_LEAST_ROWS} are needed"
    row = int(backwards[0]) + 1
    return (
        f"{trace.name}: time does not run forward at row {row}: "
        f"{trace.time_s[row - 1]:.6g} s, then {trace.time_s[row]:.6g} s"
    )


def _findings(audit: TraceAudit) -> Iterator[tuple[Severity, str]]:
    """Severity and text of each finding on the clock of a trace."""
    name, rate = audit.name, audit.rate_hz
    if audit.duration_s < _LEAST_S:
        lasts = f"{name} lasts {audit.duration_s:.3g} s"
        yield "refuse", f"{lasts}; at least {_LEAST_S:g} s are needed"
    if audit.rows < _LEAST_ROWS:
        few = f"{name} has {audit.rows} rows"
        yield "refuse", f"{few}; at least {_LEAST_ROWS} are needed"
    if rate < _SLOWEST_HZ:
        yield (
            "refuse",
            f"{name} has {rate:.3g} rows a second, too few to show motion; is its time "
            "in milliseconds instead of seconds?",
        )
    elif rate < _SLOW_HZ:
        yield (
            "limit",
            f"{name} has {rate:.3g} rows a second; below about 50, delays, armature "
            "and elasticity cannot be estimated",
        )
    if audit.gaps:
        is_long = audit.longest_gap_s >= _LONG_GAP_S
        after = "; what happened in them stays unknown" if is_long else ""
        yield (
            "limit" if is_long else "note",
            f"{name} has {audit.gaps} gaps, the longest of "
            f"{1e3 * audit.longest_gap_s:.3g} ms{after}",
        )
    if audit.jitter_s * rate > _UNEVEN:
        yield (
            "limit",
            f"{name}: ticks of {1e3 / rate:.3g} ms vary by "
            f"{1e3 * audit.jitter_s:.2g} ms; shorter delays are hidden in the jitter",
        )
