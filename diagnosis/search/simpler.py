"""An answer without what it does not need."""

from dataclasses import replace

from diagnosis.effects.effect import PlacedEffect
from diagnosis.search.compared import fairly
from diagnosis.search.result import Found
from diagnosis.search.search import Search


def simpler(search: Search, found: Found) -> Found:
    """What a search came to, less the values that are not worth their place.

    Dry friction with Stribeck's peak is dry friction where the peak is nothing. To fit
    a little better it may take any form, such as a peak as wide as all speeds: so it
    must be worth as much as one more effect.

    Args:
      search: that has run.
      found: what it came to.
    """
    winner = found.winner
    if winner is None:
        return found
    start = tuple(_without_peak(placed) for placed in winner.model)
    if start == winner.model:
        return found
    (judged,) = fairly(search, [search.judged([start])[0].model])
    if search.worth(judged.selected, winner.selected, found.nothing):
        return found
    others = [other for other in found.best[found.chosen] if other.keys != judged.keys]
    best = {**found.best, found.chosen: [judged, *others]}
    return replace(found, best=best)


def needed(search: Search, found: Found) -> Found:
    """What a search came to, less the effects without which it does as well.

    While models grow, an effect may stand for what is still wrong with another, and be
    left over once that one has found its place.

    Args:
      search: that has run.
      found: what it came to.
    """
    while found.winner is not None and found.chosen > 1:
        winner = found.winner
        rests = [
            tuple(one for one in winner.model if one is not placed)
            for placed in winner.model
        ]
        kept = [judged.model for judged in search.judged(rests)]
        best = min(fairly(search, kept), key=lambda judged: judged.evidence)
        if search.worth(best.selected, winner.selected, found.nothing):
            break
        size = found.chosen - 1
        others = [one for one in found.best.get(size, []) if one.keys != best.keys]
        found = replace(found, chosen=size, best={**found.best, size: [best, *others]})
    return found


def _without_peak(placed: PlacedEffect) -> PlacedEffect:
    """Dry friction as it is at speed and at rest, in the mean."""
    if placed.name != "stribeck_friction":
        return placed
    coulomb_nm, extra_nm, _ = placed.values
    return PlacedEffect("coulomb_friction", placed.place, (coulomb_nm + extra_nm / 2,))
