"""Searches for few effects, or for effects at many joints where few do not suffice."""

import numpy as np

from diagnosis.residuals.predictor import Predictor
from diagnosis.search.accept import accepted
from diagnosis.search.many.everywhere import everywhere
from diagnosis.search.result import SearchResult
from diagnosis.search.search import Search

ALL_CLOSED = 0.95
"""Share of the energy above the noise that few effects must remove; otherwise effects
at many joints are tried."""

TORQUES_LEFT = 1.5
"""Multiple of the sensors' squared noise from which on so much is left of torques that
effects at many joints are tried."""


def found_by(search: Search, tested: bool = True) -> tuple[SearchResult, bool]:
    """What a search finds, and whether these are effects at many joints.

    Where most joints are off beside the best single effect, effects at many joints are
    searched for at once, elsewhere where few effects leave much. Unless `tested` is
    false, few effects also have to pass closer tests.
    """
    judge = search.judge
    if judge.fit.knows_healthy_torques:
        return accepted(judge, search.run(anyway=True)), False
    result = search.run()
    if search.widespread:
        wide = everywhere(judge, result, search.large)
        if wide is not result:
            return wide, True
        judge.calibrate(())
        result = search.run(anyway=True)
        return (accepted(judge, result) if tested else result), False
    few = accepted(judge, result) if tested else result
    if not more_is_missing(judge.fit, few):
        return few, False
    wide = everywhere(judge, few, search.large)
    return wide, wide is not few


def more_is_missing(fit: Predictor, result: SearchResult) -> bool:
    """Whether few effects leave so much that effects at many joints are tried.

    Never on a floating base, where that would take an hour.
    """
    if fit.plant.base == "floating":
        return False
    if not fit.by_torque:
        return result.leaves_much(ALL_CLOSED)
    model = result.winner.model if result.winner else ()
    (left,) = fit.without_tolerances().residuals([model])
    wide = (fit.channels.noise / fit.channels.floor)[fit.channel]
    return bool(np.sum((wide * left) ** 2) > TORQUES_LEFT * fit.scored.sum())
