"""The integration error of simulations, measured with shorter steps.

The error of a coarse time step is smooth and hardly depends on the model. So it is
measured once for one model, by Richardson extrapolation (first order: twice the finer
result minus the coarser one), and taken out of simulations of others.
"""

from collections.abc import Callable
from dataclasses import dataclass

from groundwalk.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class IntegrationError:
    """What to add to simulated values (rows, c) to take the integration error out.

    Attributes:
      whole: for simulations with a step.
      half: for those with half of it.
      quarter: for those with a quarter of it.
      extrapolated: for the extrapolation from those with half and a quarter of it.
    """

    whole: FloatArray
    half: FloatArray
    quarter: FloatArray
    extrapolated: FloatArray

    def part(self, rows: slice) -> "IntegrationError":
        """The integration error in some rows."""
        return IntegrationError(*(one[rows] for one in vars(self).values()))

    @property
    def of_parts(self) -> dict[int, FloatArray]:
        """What to add where so many steps are taken for one."""
        return {1: self.whole, 2: self.half, 4: self.quarter}

    @classmethod
    def of(
        cls, values: Callable[[float], FloatArray], step_s: float, finest_s: float
    ) -> tuple["IntegrationError", FloatArray]:
        """Measure it where `values` (rows, c) are those with a time step [s].

        The shortest of the steps is `finest_s`. Also returns what the extrapolation
        leaves, an error of second order.
        """
        own = [step_s / part for part in (1, 2, 4)]
        finest = [finest_s * part for part in (4, 2, 1)]
        found = {one: values(one) for one in dict.fromkeys([*own, *finest])}
        coarse, fine, finer = (found[one] for one in finest)
        right = 2 * finer - fine
        extrapolated = right - (2 * found[own[2]] - found[own[1]])
        whole, half, quarter = (right - found[one] for one in own)
        error = cls(whole, half, quarter, extrapolated)
        return error, (finer - fine) - (fine - coarse) / 2
