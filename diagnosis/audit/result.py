"""What an audit of recordings found out, as data."""

import json
import math
from dataclasses import asdict, dataclass
from typing import Literal

from diagnosis.traces.noise import Noise

Severity = Literal["note", "limit", "refuse"]


@dataclass(frozen=True)
class Finding:
    """Something about the recordings that a reader should know.

    Attributes:
      severity: "note": good to know; "limit": something cannot be said from these
        data; "refuse": nothing can.
      text: a plain sentence with trace, channel and number.
      trace: whose; empty if of all together.
      channel: such as "position.LKneePitch" or "time"; empty if of the whole trace.
    """

    severity: Severity
    text: str
    trace: str = ""
    channel: str = ""


@dataclass(frozen=True)
class ChannelAudit:
    """One channel of a trace, numbers in its unit.

    Attributes:
      name: as the recording's column.
      noise_std: of white noise besides rounding.
      quantum: step to which it is rounded, None if continuous.
      constant: all values are the same.
      clipped_share: of rows in which it is stuck at an extreme.
      missing_share: of rows without a value.
      longest_missing_s: the longest stretch of them.
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
        """Both kinds of noise."""
        return Noise(self.noise_std, self.quantum)


@dataclass(frozen=True)
class JointAudit:
    """How a joint moved in a trace; for a sliding joint read m for rad.

    Attributes:
      name: the joint.
      low_rad, high_rad: the smoothed positions' range.
      speed_rad_s: that 99 % of the rows stay below.
      reversals: changes of direction.
      moves: by more than noise and quantum.
    """

    name: str
    low_rad: float
    high_rad: float
    speed_rad_s: float
    reversals: int
    moves: bool


@dataclass(frozen=True)
class TraceAudit:
    """One trace.

    Attributes:
      name: the trace.
      rows: its number of rows.
      duration_s: from the first to the last one.
      rate_hz: by the median tick.
      jitter_s: standard deviation of ticks that are no gaps.
      gaps: ticks longer than two and a half median ones.
      longest_gap_s: the longest of them, 0 without any.
      repeated_share: of rows that repeat the one before while the robot moves.
      channels: all that it has.
      joints: all of the plant's.
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
    """All traces and what was found."""

    traces: tuple[TraceAudit, ...]
    findings: tuple[Finding, ...]

    @property
    def refused(self) -> tuple[str, ...]:
        """Why nothing can be said from these recordings; empty if something can."""
        return self._texts("refuse")

    @property
    def moving(self) -> frozenset[str]:
        """Joints that move in some trace."""
        return frozenset(
            joint.name for trace in self.traces for joint in trace.joints if joint.moves
        )

    @property
    def limits(self) -> tuple[str, ...]:
        """What these recordings cannot tell, in plain sentences."""
        return self._texts("limit")

    def to_json(self) -> str:
        """The audit as JSON text; numbers that are not finite become null."""
        return json.dumps(_plain(asdict(self)), allow_nan=False, indent=1)

    def _texts(self, severity: Severity) -> tuple[str, ...]:
        return tuple(item.text for item in self.findings if item.severity == severity)


def _plain(value: object) -> object:
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
