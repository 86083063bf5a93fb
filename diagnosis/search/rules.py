"""Settings of a search for missing effects."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Rules:
    """How many models a search tries, and when it believes an effect.

    The defaults were set on recordings with hidden effects of known truth. An energy is
    half the sum of squared residuals in units of noise [nats]; a gain is a reduction of
    energy; a guess is a model whose gain is estimated linearly, without simulation.

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
      least_gain: gain [nats] on the selection data that an effect needs.
      least_hint: the same for a single effect that also shows on the fitting data.
      fitted_only: a single effect that gains this multiple of `least_gain` on the
        fitting data needs no gain on the selection data.
      least_pattern: an effect must gain as much as a pattern of this rms [noise] would;
        smaller patterns are errors of integrators and clocks.
      least_share_of_rest: share of the remaining energy above the noise that an effect
        must remove.
      unsure_floor: relative uncertainty of the noise energy, within which no share is
        required.
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
    least_gain: float = 15.0
    least_hint: float = 3.0
    fitted_only: float = 4.0
    least_pattern: float = 0.15
    least_share_of_rest: float = 0.3
    unsure_floor: float = 0.1
    least_share: float = 0.0001
