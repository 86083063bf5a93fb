"""Settings of a search for missing effects."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Rules:
    """How many models a search tries, and when it believes an effect.

    The defaults were set on concealed cases of known truth. Energies are half the sums
    of squared residuals in units of noise; a gain is a reduction of energy [nats].

    Attributes:
      single_effects: how many single effects are fitted at the start.
      further_effects: how many of them are reserved for kinds of effects that are not
        among the best guesses.
      beam: how many of the best models are extended in each round.
      growths_each: in how many ways each of them is extended.
      pairs: how many pairs of effects are fitted because of their guessed joint gain.
      first_steps: steps of a fit after which most models are given up.
      finished: how many models at most are fitted to the end.
      drop_behind: give a model up after the first steps if it explains less than the
        best one by more than this share of what the best one explains.
      refinements: how often at most the best models are fitted again after the
        integration error has been measured at the best one.
      compared: how many of the best models are compared with exact integration errors.
      swaps: how many replacements are tried for each effect of the best model.
      largest: most effects in a model.
      suspicious: while the error exceeds this multiple of the noise energy, pairs are
        tried even if no single effect helps; below it a search may end.
      promising: below that level a search ends if no guess gains this share of
        `least_gain`.
      least_gain: gain [nats] on the selection data that an effect needs.
      least_hint: gain [nats] on the selection data that is enough for a single effect
        which also shows on the fitting data.
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
