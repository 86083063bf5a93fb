"""What each joint shows, as plain data: curves with bands, shares, and delays."""

import json
from dataclasses import asdict, dataclass
from typing import Any, Literal

Source = Literal["measured", "servo", "target", "passive", "unknown"]
"""Where the torque that a joint had is known from: it was measured, its servo asks for
it by the declared gains, or it was commanded; or nothing drives the joint; or it is not
known."""

Kind = Literal["speed", "load", "position", "turn", "error"]
"""What a curve shows: loss torque over speed, over load (the torque that the motion
needs), over position, or over the travel since the last turn; or the tracking error
over torque."""

Way = Literal["both", "forward", "backward"]
"""The direction of motion in which the rows of a curve were recorded."""


@dataclass(frozen=True)
class Curve:
    """Means in bins, with a band of what pieces of the recordings show.

    A piece is a recording, or a block of time, see `Seen`. Bins with rows of fewer than
    two pieces are left out, so that each has a band. At a sliding joint units have m
    for rad and N for N m.

    Attributes:
      kind: what the curve shows.
      way: the direction of motion.
      over: the quantity on the horizontal axis in words, such as "speed".
      over_unit: its unit, such as "rad/s".
      unit: unit of the values: of a torque "N m", of a tracking error "rad".
      at: mean of the horizontal quantity in each bin, rising.
      middle: median over pieces of the pieces' means in each bin.
      low: 10 % quantile over pieces of these means.
      high: 90 % quantile over pieces of these means.
      law: the same as `middle` of what the effects of a verdict change; None without.

    Example:
      >>> [one.middle for one in joint.curves if one.kind == "speed"]
    """

    kind: Kind
    way: Way
    over: str
    over_unit: str
    unit: str
    at: tuple[float, ...]
    middle: tuple[float, ...]
    low: tuple[float, ...]
    high: tuple[float, ...]
    law: tuple[float, ...] | None = None


@dataclass(frozen=True)
class Share:
    """How much of the variance of the loss torque goes with one quantity.

    Shares are those explained in pieces of the recordings that a regression did not
    use; 0 is nothing, also where the regression did harm there.

    Attributes:
      name: the quantity in words, such as "sign of speed".
      alone: share from 0 to 1 that it explains by itself.
      lost: share that all quantities together explain no more without it.
    """

    name: str
    alone: float
    lost: float


@dataclass(frozen=True)
class Delay:
    """How late a joint follows its command [s]: its servo's lag and all delays.

    A command counts as that of the middle of the tick in which it holds.

    Attributes:
      middle_s: median over pieces.
      low_s: 10 % quantile over pieces.
      high_s: 90 % quantile over pieces.
      pieces_s: the delay in each piece in which the joint moved, by its name.
    """

    middle_s: float
    low_s: float
    high_s: float
    pieces_s: dict[str, float]


@dataclass(frozen=True)
class SeenJoint:
    """What one joint shows.

    Attributes:
      joint: its name.
      source: where its torque is known from.
      unknown: sentences about what is not known, and why.
      torque_unit: "N m", at a sliding joint "N".
      loss_rms: rms of the loss torque while the joint moves; None if it is not known.
      needed_rms: rms of the torque that the motion needs; None if it is not known.
      stiffness: declared stiffness of its servo in torque unit per rad (or m), the same
        in all recordings; None if it has none, or they differ.
      curves: all curves that have three bins or more.
      shares: how much of the variance of the loss torque goes with what.
      together: share that all of these explain together, in pieces not used.
      noise_share: share of the variance by which the loss torque differs where other
        pieces have nearly the same motion, so that no function of it explains it; None
        where no two pieces move alike.
      delay: how late it follows; None without commands, or if it hardly moves.
    """

    joint: str
    source: Source
    unknown: tuple[str, ...] = ()
    torque_unit: str = "N m"
    loss_rms: float | None = None
    needed_rms: float | None = None
    stiffness: float | None = None
    curves: tuple[Curve, ...] = ()
    shares: tuple[Share, ...] = ()
    together: float | None = None
    noise_share: float | None = None
    delay: Delay | None = None


@dataclass(frozen=True)
class Seen:
    """What all joints show.

    Attributes:
      joints: the joints, in the model's order.
      pieces: names of the pieces that bands and shares compare.
      by: what a piece is: a recording, or with fewer than three recordings an equal
        part of the time of one.
      cutoff_hz: frequency below which motion and torque are compared; None if no
        torque is known.

    Example:
      >>> plant, traces = read_traces(["a.parquet"], "so101")
      >>> look(plant, traces).joints[0].loss_rms
    """

    joints: tuple[SeenJoint, ...]
    pieces: tuple[str, ...]
    by: Literal["recordings", "blocks"]
    cutoff_hz: float | None = None

    def to_json(self) -> str:
        """All of this as JSON, in SI units, numbers with six digits."""
        return json.dumps(_shortened(asdict(self))) + "\n"


def _shortened(value: Any) -> Any:
    """A JSON value with at most six digits in each number."""
    if isinstance(value, float):
        return float(f"{value:.6g}")
    if isinstance(value, dict):
        return {key: _shortened(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [_shortened(one) for one in value]
    return value
