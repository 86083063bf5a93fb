"""An answer with a simpler effect in the stead of one that contains it."""

from dataclasses import replace

from diagnosis.compared import fairly
from diagnosis.effect import Placed
from diagnosis.search import Search
from diagnosis.search_result import Found


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


def _without_peak(placed: Placed) -> Placed:
    """Dry friction as it is at speed and at rest, in the mean."""
    if placed.effect != "stribeck_friction":
        return placed
    coulomb_nm, extra_nm, _ = placed.values
    return Placed("coulomb_friction", placed.place, (coulomb_nm + extra_nm / 2,))
