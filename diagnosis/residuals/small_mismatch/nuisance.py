"""The small mismatch that every robot model has, fitted beside what is looked for.

Masses are known to some percent, gains and damping to some more, and every gear rubs a
little. Many such errors together change a replay far more than its noise, and not in
proportion to each. So their likeliest values are fitted (`nuisance_fit.py`), and what
is looked for is tried beside them; to first order around these values all others that
are usual stay possible (`../tolerance.py`). That is Laplace's approximation of the
likelihood with the small mismatch marginalised.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import block_diag

from diagnosis.effects.library import effect
from diagnosis.effects.parts import Parameter, PlacedEffect
from diagnosis.plant.plant import Plant
from diagnosis.residuals.changes import Changes
from diagnosis.residuals.replays import Model
from diagnosis.residuals.small_mismatch.likely_sizes import gain_of
from diagnosis.residuals.small_mismatch.usual_errors import (
    USUAL,
    component_of,
    far_of,
    is_possible,
    usual_errors,
    value_at,
)
from diagnosis.residuals.tolerance import Tolerance
from diagnosis.traces.trace import Trace
from groundwalk.arrays import BoolArray, FloatArray

AT_END = 0.01
"""Distance from that within which an error is as large as it may be."""


@dataclass(frozen=True, eq=False)
class Nuisance:
    """Small mismatch of a robot model, with likely values.

    Attributes:
      units: each error by one standard deviation.
      parameters: those of the effect of each unit.
      sizes: (k,) likely values, in standard deviations.
      changes: those of a residual by one standard deviation of each.
      seen_at: (k,) errors, in standard deviations, and effects of the model at which
        these changes were simulated; None if they were not.
    """

    plant: Plant
    units: tuple[PlacedEffect, ...]
    parameters: tuple[tuple[Parameter, ...], ...]
    sizes: FloatArray
    changes: Changes
    seen_at: tuple[FloatArray, frozenset[str]] | None = None

    @classmethod
    def of(cls, plant: Plant, traces: Sequence[Trace], entries: int) -> "Nuisance":
        """All small mismatch that a robot model may have, of size zero.

        `entries` is the number of those of a residual of the traces.
        """
        units = tuple(usual_errors(plant, traces))
        own = tuple(effect(one.name).parameters(plant, one.place) for one in units)
        none = np.zeros(len(units)), Changes.of(np.zeros((len(units), entries)))
        return cls(plant, units, own, *none)

    def part(self, entries: slice) -> "Nuisance":
        """These errors, with what they change in some entries of a residual."""
        return replace(self, changes=self.changes.part(entries))

    def key(self, index: int) -> str:
        """The "effect@place" of an error."""
        return self.units[index].key

    def beside(self, keys: Collection[str]) -> Model:
        """The effects that stand for the errors, less those at some "effect@place"."""
        values = dict[str, list[float]]()
        some = zip(self.units, self.parameters, self.sizes.tolist(), strict=True)
        for unit, every, size in some:
            if unit.key in keys:
                continue
            own = values.setdefault(unit.key, [one.neutral for one in every])
            i = component_of(every, unit)
            own[i] = value_at(every[i], size * far_of(every[i], unit.values[i]))
        first = {unit.key: unit for unit in reversed(self.units)}
        return tuple(replace(first[k], values=tuple(own)) for k, own in values.items())

    def none_at(self, keys: Collection[str]) -> Model:
        """Effects without any change at those of some "effect@place" that it has."""
        found = {}
        for unit, every in zip(self.units, self.parameters, strict=True):
            if unit.key in keys:
                values = tuple(one.neutral for one in every)
                found[unit.key] = replace(unit, values=values)
        return tuple(found.values())

    def unusual(self, left: FloatArray) -> list[tuple[PlacedEffect, float]]:
        """Errors as large as they may be, and what they would gain if larger [nats].

        `left` (N,) is the residual beside these errors. The gain is a linear estimate,
        with the error as large as suits and others as likely as before.
        """
        low, high = self.bounds()
        far = np.minimum(self.sizes - low, high - self.sizes) < AT_END
        large = np.abs(self.sizes) > USUAL - AT_END
        first = {one.key: i for i, one in reversed([*enumerate(self.units)])}
        found = []
        for placed in self.beside(()):
            i = first[placed.key]
            own = [k for k in range(len(far)) if self.key(k) == placed.key]
            if large[own].any() and is_possible(placed, self.parameters[i]):
                gain = gain_of(self.changes, left, self.sizes, own, far)
                found.append((placed, gain))
        return found

    def free_of(self, keys: Collection[str]) -> BoolArray:
        """(k,) whether each error is not at some "effect@place"."""
        return np.array([unit.key not in keys for unit in self.units], bool)

    def at(self, sizes: FloatArray) -> "Nuisance":
        """The errors with other (k,) values, in standard deviations."""
        return replace(self, sizes=sizes)

    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """(k,) smallest and (k,) largest values, in standard deviations.

        What a model states may be wrong to either side; what it leaves out, such as
        friction, is never negative.
        """
        ends = []
        for unit in self.units:
            kind = effect(unit.name)
            stated = kind.tolerance(self.plant, unit.place) > 0
            ends.append((-USUAL if stated else 0.0, USUAL))
        low, high = np.array(ends).reshape(-1, 2).T
        return low, high

    def tolerance(
        self, spread: FloatArray | None = None, further: FloatArray | None = None
    ) -> Tolerance:
        """The space of what other errors than these would change.

        `spread` (k + m, k + m) is their covariance in standard deviations, and that of
        what changes residuals by `further` (m, N); independent if None.
        """
        keys = [one.key for one in self.units]
        more = 0 if further is None else len(further)
        if spread is not None and len(spread) != len(keys) + more:
            # what is uncertain differs, as other joints have servos
            last = spread[len(spread) - more :, len(spread) - more :]
            spread = block_diag(np.eye(len(keys)), last)
        if further is None or not more:
            return Tolerance(self.changes, keys, self.sizes, spread)
        every = Changes.of(np.vstack([self.changes.whole(), further]))
        sizes = np.append(self.sizes, np.zeros(more))
        return Tolerance(every, [*keys, *more * [""]], sizes, spread)
