"""Many joints that lack the same: what all servos have, and a bare model has not.

A search for one, two or three effects suits a robot whose model once was right. The
bare model of a real robot lacks the same physics at every joint, differently large.
Here whole kinds are added, each at all joints where it explains something.
"""

from collections.abc import Sequence

from diagnosis.effect import Placed
from diagnosis.library import EFFECTS
from diagnosis.predictor import Model
from diagnosis.screening import Guess, Screen
from diagnosis.search import Search
from diagnosis.search_result import Found, Judged
from diagnosis.signatures import signatures

KINDS = tuple(
    name
    for name, kind in EFFECTS.items()
    if kind.place_kind in ("joint", "commands", "encoders")
    and name not in ("joint_elasticity", "end_stop", "servo_fade")
)
"""What servos have. Stops and fading are single faults."""

MOST_KINDS, TRIED = 6, 6
LEAST_SHARE = 0.1
"""Of the energy above the noise that is left: what a kind must take away."""

MUCH_BETTER = 0.5
"""Part of what the best small model leaves that must go for so many effects."""


def widespread(search: Search, found: Found) -> Found:
    """A model of whole kinds, if it does much better than the search's; else that.

    Args:
      search: that has run.
      found: what it came to.
    """
    best: Judged | None = None
    model: Model = ()
    residual, energy = search.fit.residuals([()])[0], found.nothing
    for _ in range(MOST_KINDS):
        signs = signatures(search.fit, model, search.usage, (), KINDS)
        guesses = Screen(search.fit, signs).singles(residual)
        added = _by_kind(guesses, search.least_gain, model)
        tried = search.judged([(*model, *more) for more in added[:TRIED]])
        if not tried or energy - tried[0].selected < LEAST_SHARE * (
            energy - search.floor
        ):
            break
        best = tried[0]
        model, residual, energy = best.model, best.fit.residual, best.selected
    left = found.winner.selected if found.winner else found.nothing
    needed = max(MUCH_BETTER * (left - found.floor), search.least_gain)
    if best is None or left - energy < needed:
        return found
    return Found(found.nothing, found.floor, {len(model): [best]}, len(model))


def _by_kind(guesses: Sequence[Guess], least: float, model: Model) -> list[Model]:
    """For each kind its guesses at all joints together, the best kinds first."""
    known = {placed.key for placed in model}
    together: dict[str, tuple[float, list[Placed]]] = {}
    for guess in guesses:
        (placed,) = guess.model
        if guess.gain < least or placed.key in known:
            continue
        gain, every = together.get(placed.effect, (0.0, []))
        together[placed.effect] = gain + guess.gain, [*every, placed]
    ranked = sorted(together.values(), key=lambda one: -one[0])
    return [tuple(every) for _, every in ranked]
