"""The curves of one joint: loss torque over what it may go with, and tracking error."""

from collections.abc import Callable, Iterator

import numpy as np

from diagnosis.plant.plant import Plant
from diagnosis.seen.bins import Binned, binned, even_edges, quantile_edges
from diagnosis.seen.result import Curve, Kind, Source, Way
from diagnosis.seen.rows import Rows
from groundwalk.arrays import BoolArray, FloatArray, IntArray

SPEED_BINS, LOAD_BINS, POSITION_BINS, TURN_BINS = 8, 10, 16, 12
"""Largest number of bins of a curve, of speed in each direction."""

FEWEST_BINS = 3
"""Fewest bins of a curve: fewer show no course."""

FAR_TURN = 0.9
"""Quantile of the travel since a turn up to which it is shown."""

WAYS: tuple[tuple[Way, float], ...] = (("forward", 1.0), ("backward", -1.0))


def curves_of(
    plant: Plant, rows: Rows, piece: IntArray, joint: int, source: Source
) -> tuple[Curve, ...]:
    """The curves of one joint, of whose torque the source is given.

    `piece` (T,) is the piece of each row. The tracking error is shown over the torque
    that the servo's stiffness must give: the measured one or, as a servo's torque
    follows from its error, the one that the motion needs, plus declared damping.
    """
    makers = [_speed, _position, _turn]
    if source != "passive":  # else its loss torque is its load, with the other sign
        makers = [_speed, _load, _position, _turn, _error]
    drawn = _Drawn(plant, rows, piece, joint, source)
    found = [curve for maker in makers for curve in maker(drawn)]
    return tuple(one for one in found if len(one.at) >= FEWEST_BINS)


class _Drawn:
    """One joint's columns, and what its curves have in common."""

    def __init__(
        self, plant: Plant, rows: Rows, piece: IntArray, joint: int, source: Source
    ) -> None:
        self.name, self.plant, self.piece = plant.joints[joint], plant, piece
        self.position = rows.position_rad[:, joint]
        self.speed = rows.velocity_rad_s[:, joint]
        self.loss, self.law = rows.loss_nm[:, joint], rows.law_nm[:, joint]
        self.needed, self.torque = rows.needed_nm[:, joint], rows.torque_nm[:, joint]
        self.error, self.travel = rows.error_rad[:, joint], rows.travel_rad[:, joint]
        self.damping = rows.damping_nm[:, joint]
        self.way, self.measured = rows.way[:, joint], source == "measured"
        self.counts = rows.counts[:, joint] & np.isfinite(self.loss)
        self.moves = rows.moves[:, joint] & np.isfinite(self.loss)

    def curve(
        self,
        kind: Kind,
        way: Way,
        axis: tuple[str, str, FloatArray],
        chosen: BoolArray,
        edges: Callable[[FloatArray], FloatArray],
    ) -> Iterator[Curve]:
        """The curve over an axis (words, unit, values) in chosen rows; none of too few.

        `edges` finds the edges of bins for the chosen values.
        """
        over, over_unit, at = axis
        of_error = kind == "error"
        values = self.error if of_error else self.loss
        chosen = chosen & np.isfinite(values) & np.isfinite(at)
        if chosen.sum() < FEWEST_BINS:
            return
        columns = at[chosen], values[chosen], self.law[chosen], self.piece[chosen]
        found: Binned = binned(*columns, edges(at[chosen]))
        at_, middle, low, high, law = (tuple(one.tolist()) for one in found)
        acts = bool(self.law.any()) and not of_error
        units = self.unit(over_unit), self.unit("rad" if of_error else "N m")
        lawful = law if acts else None
        yield Curve(kind, way, over, *units, at_, middle, low, high, lawful)

    def unit(self, unit: str) -> str:
        """A unit at this joint, which may slide."""
        return self.plant.unit(unit, self.name)


def _speed(joint: _Drawn) -> Iterator[Curve]:
    axis = "speed", "rad/s", joint.speed
    yield from joint.curve("speed", "both", axis, joint.counts, _two_sided)


def _load(joint: _Drawn) -> Iterator[Curve]:
    axis = "torque that the motion needs", "N m", joint.needed
    for way, sign in WAYS:
        rows = joint.counts & (joint.speed * sign > 0)
        yield from joint.curve("load", way, axis, rows, _quantiles(LOAD_BINS))


def _position(joint: _Drawn) -> Iterator[Curve]:
    axis = "position", "rad", joint.position
    for way, sign in WAYS:
        rows = joint.counts & (joint.speed * sign > 0)
        yield from joint.curve("position", way, axis, rows, _even(POSITION_BINS))


def _turn(joint: _Drawn) -> Iterator[Curve]:
    axis = "travel since the last turn", "rad", joint.travel
    for way, sign in WAYS:
        rows = joint.moves & (joint.way == sign)
        yield from joint.curve("turn", way, axis, rows, _near_turns)


def _error(joint: _Drawn) -> Iterator[Curve]:
    axis = "needed torque and damping", "N m", joint.needed + joint.damping
    if joint.measured:
        axis = "measured torque and damping", "N m", joint.torque + joint.damping
    for way, sign in WAYS:
        rows = joint.counts & (joint.speed * sign > 0)
        yield from joint.curve("error", way, axis, rows, _quantiles(LOAD_BINS))


def _two_sided(speed: FloatArray) -> FloatArray:
    """Edges for both directions of speed, none of whose bins holds both."""
    edges = [np.zeros(0)]
    for own in (speed[speed < 0], speed[speed > 0]):
        edges += [quantile_edges(own, SPEED_BINS)] if len(own) else []
    return np.unique(np.concatenate(edges))


def _quantiles(bins: int) -> Callable[[FloatArray], FloatArray]:
    return lambda values: quantile_edges(values, bins)


def _even(bins: int) -> Callable[[FloatArray], FloatArray]:
    return lambda values: even_edges(values, bins)


def _near_turns(travel: FloatArray) -> FloatArray:
    """Edges that are the finer, the nearer the last turn is."""
    far = np.sqrt(np.quantile(travel, FAR_TURN))
    return np.unique(np.linspace(0, far, TURN_BINS + 1) ** 2)
