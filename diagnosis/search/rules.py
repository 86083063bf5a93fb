"""Settings of a search for missing effects."""

from dataclasses import dataclass, replace


@dataclass(frozen=True)
class Rules:
    """How many models a search tries, and when it believes an effect.

    An energy is half the sum of squared residuals in units of noise [nats]; a gain is a
    reduction of energy; a guess is a model whose gain is estimated linearly, without
    simulation.

    Attributes:
      single_effects: number of single effects that are fitted at the start.
      further_effects: number of these that is reserved for kinds of effects that are
        not among the best guesses.
      beam: number of the best models that are extended in each round.
      growths_each: number of ways in which each of them is extended.
      pairs: number of pairs of effects that are fitted, the best guesses.
      first_steps: steps of a fit after which most models are given up.
      finished: largest number of models that are fitted to the end.
      drop_behind: give a model up after the first steps if it explains less than the
        best one by more than this share of the energy that the best one explains.
      refinements: most times that the best models are fitted again, with the
        integration error measured at the best one.
      compared: number of the best models that are compared with exact integration.
      swaps: number of replacements that are tried for each effect of the best model.
      largest: largest number of effects in a model.
      suspicious: while the energy exceeds this multiple of the noise energy, pairs are
        tried even if no single effect helps; below it a search may end.
      promising: below that level a search ends if no guess gains this share of
        `least_gain`.
      least_share: share of the nominal sim's energy above the noise that an effect must
        remove.

    Example:
      >>> diagnose(plant, traces, seed, Rules(largest=1))  # a single effect only
    """

    single_effects: int = 12
    further_effects: int = 4
    beam: int = 3
    growths_each: int = 4
    pairs: int = 8
    first_steps: int = 3
    finished: int = 10
    drop_behind: float = 0.5
    refinements: int = 4
    compared: int = 8
    swaps: int = 6
    largest: int = 3
    suspicious: float = 1.5
    promising: float = 0.5
    least_share: float = 0.0

    @property
    def again(self) -> "Rules":
        """Settings of a search that begins with what an earlier one found."""
        return replace(
            self,
            single_effects=min(self.single_effects, 5),
            further_effects=min(self.further_effects, 2),
            growths_each=min(self.growths_each, 2),
            pairs=min(self.pairs, 2),
            finished=min(self.finished, 5),
            refinements=min(self.refinements, 2),
            compared=min(self.compared, 4),
            swaps=min(self.swaps, 3),
        )
