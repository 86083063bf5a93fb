"""The result of an audit of recordings, as data and as JSON."""

import json
from dataclasses import asdict, dataclass
from typing import Any, Literal

from diagnosis.traces.noise import Noise

Severity = Literal["note", "limit", "refuse"]


@dataclass(frozen=True)
class Finding:
    """One finding of an audit, with its consequence.

    Attributes:
      severity: "note": for information; "limit": some effects cannot be judged with
        these data; "refuse": the recording cannot be used.
      text: a sentence for the report.
      trace: name of the trace; empty if the finding is about all of them.
      channel: such as "position.LKneePitch" or "time"; empty for a whole trace.
    """

    severity: Severity
    text: str
    trace: str = ""
    channel: str = ""


@dataclass(frozen=True)
class ChannelAudit:
    """Measurements of one channel of a trace, in the channel's unit.

    Attributes:
      name: name of the column in the recording, such as "position.LKneePitch".
      noise_std: standard deviation of white noise, rounding not included.
      quantum: step to which values are rounded; None if they are continuous.
      clipped_share: share of rows in which the channel is stuck at an extreme.
    """

    name: str
    noise_std: float
    quantum: float | None
    constant: bool
    clipped_share: float
    missing_share: float
    longest_missing_s: float

    @property
    def noise(self) -> Noise:
        """White noise and quantum as one `Noise`."""
        return Noise(self.noise_std, self.quantum)


@dataclass(frozen=True)
class JointAudit:
    """The motion of one joint in a trace; sliding joints have m for rad.

    Attributes:
      low_rad, high_rad: range of the smoothed positions.
      speed_rad_s: speed below which the joint is in 99 % of the rows.
      moves: whether the range exceeds noise and rounding.
    """

    name: str
    low_rad: float
    high_rad: float
    speed_rad_s: float
    reversals: int
    moves: bool


@dataclass(frozen=True)
class TraceAudit:
    """Measurements of one trace.

    Attributes:
      rate_hz: one over the median tick (time between rows).
      jitter_s: standard deviation of the ticks that are no gaps.
      gaps: number of ticks longer than two and a half median ticks.
      repeated_share: share of the rows in motion that repeat the row before.
    """

    name: str
    rows: int
    duration_s: float
    rate_hz: float
    jitter_s: float
    gaps: int
    longest_gap_s: float
    repeated_share: float = 0.0
    channels: tuple[ChannelAudit, ...] = ()
    joints: tuple[JointAudit, ...] = ()


@dataclass(frozen=True)
class Audit:
    """Measurements of all traces, and the findings about them.

    The findings are in the order of the traces, those about all together last.
    """

    traces: tuple[TraceAudit, ...]
    findings: tuple[Finding, ...]

    @property
    def refused(self) -> tuple[str, ...]:
        """Sentences on why these recordings cannot be used; empty if they can."""
        return self._texts("refuse")

    @property
    def moving(self) -> frozenset[str]:
        """Names of the joints that move in at least one trace."""
        return frozenset(
            joint.name for trace in self.traces for joint in trace.joints if joint.moves
        )

    @property
    def limits(self) -> tuple[str, ...]:
        """Sentences on what cannot be concluded from these recordings."""
        return self._texts("limit")

    def to_json(self) -> str:
        """The audit as JSON text; numbers that are not finite become null."""
        return json.dumps(self.to_plain(), indent=1)

    def to_plain(self) -> dict[str, Any]:
        """The audit as plain data for JSON; numbers that are not finite become None."""
        text = json.dumps(asdict(self))
        plain: dict[str, Any] = json.loads(text, parse_constant=lambda _: None)
        return plain

    def _texts(self, severity: Severity) -> tuple[str, ...]:
        return tuple(item.text for item in self.findings if item.severity == severity)
