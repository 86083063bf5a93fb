"""Finds effects at many joints in the torques that servos ask for.

Replays of a robot that is far from its model mix the errors of all joints, and what is
left of them goes with nothing. Torques of one joint do not mix with those of others,
and a comparison takes a hundredth of a replay's time. So first models are found there.
"""

from collections.abc import Sequence

import numpy as np

from diagnosis.effects.library import all_effects, effect
from diagnosis.residuals.channels import MORE_THAN_NOISE, shared_channels
from diagnosis.residuals.predictor import Model
from diagnosis.residuals.torques.asked_torques import asked_motions
from diagnosis.residuals.torques.torque_evidence import with_used_torques
from diagnosis.residuals.torques.torque_predictor import TorquePredictor
from diagnosis.search.fitting import ran_into_bound
from diagnosis.search.judging import Judge
from diagnosis.search.many.each_joint import each_joint
from diagnosis.search.many.fits import Fits
from diagnosis.search.many.pruning import pruned, shared
from diagnosis.search.many.shared_first import shared_first
from diagnosis.search.result import Judged
from diagnosis.traces.trace import Trace

STRONG = 5.0
"""Evidence [nats] for a model in which gains that a robot's maker states are doubted
from which on it is preferred: Kass and Raftery 1995, "Bayes factors", call more very
strong."""


def from_asked_torques(fits: Fits) -> Judged | None:
    """The best model that a search finds from models of asked torques.

    Effects that scale a servo's torque, such as another gain, explain much of what
    other masses and frictions do, and a search that takes them first does not find
    back. So there is a search from a model without them as well, which is given up for
    strong evidence. None if no first model is better than none.
    """
    best: Judged | None = None
    for model in in_asked_torques(fits):
        first = _free(fits, model)
        if not first:
            continue
        other = pruned(fits, shared_first(fits, first))
        best = other if best is None else _believed(fits, best, other)
    return best


def _free(fits: Fits, model: Model) -> Model:
    """A model fitted to the motions, without effects that run into a bound there.

    () if it is not better than none.
    """
    one, nothing = fits.fitted(model), fits.nominal()
    free = tuple(each for each in one.model if not ran_into_bound(one.fit, each))
    if len(free) < len(one.model):
        return _free(fits, free)
    return one.model if fits.ebic(nothing).prefers(one, nothing) else ()


def _believed(fits: Fits, best: Judged, other: Judged) -> Judged:
    """The other model if the evidence for it is strong, else the best one.

    Any evidence suffices if the best one doubts servos' gains as well. Recordings weigh
    as suits what the best one leaves in them.
    """
    best, other = fits.exact(best), fits.fitted(other.model)
    ebic = fits.ebic(best)
    doubts = any(effect(placed.name).scales_servo for placed in best.model)
    if ebic.score(other) < ebic.score(best) - (0.0 if doubts else STRONG):
        return fits.exact(other)
    return best


def in_asked_torques(fits: Fits) -> list[Model]:
    """Models of the torques for which servos ask by their declared gains.

    The first one has no effects that scale these torques, the second may have any. None
    if the torques are not known, or nothing is found.
    """
    sets = fits.fit.traces, fits.judge.select.traces
    plant = fits.fit.plant
    known = _as_well_known(asked_motions(plant, [*sets[0], *sets[1]]))
    both = [[known[one.name] for one in some if one.name in known] for some in sets]
    if not all(both):
        return []
    plant = with_used_torques(plant, list(known.values()))
    channels = shared_channels(plant, list(known.values()))
    own, other = (TorquePredictor(plant, some, channels) for some in both)
    if not (own.scored.any() and other.scored.any()):
        return []
    judge = Judge(own, other, fits.judge.rules, hooks=fits.judge.hooks)
    scaling = [name for name, kind in all_effects().items() if kind.scales_servo]
    tried = [Fits(judge, without, fits.weighs) for without in (scaling, ())]
    found = [best_in_torques(one) for one in tried]
    return [one.model for one in found if one.model]


def _as_well_known(traces: Sequence[Trace]) -> dict[str, Trace]:
    """Those traces whose torques are known nearly as well as those of most, by name.

    The noise of the torque that a motion needs is that of its smoothing, which leaves
    much where the motion is faster than in other recordings. Where a recording is too
    short to be smoothed, nothing is known.
    """
    noise = {
        one: one.motion.noise_nm
        for one in traces
        if one.motion is not None and one.motion.counts.any()
    }
    if not noise:
        return {}
    usual = np.maximum(np.median(list(noise.values()), axis=0), 1e-12)
    times = {one: float(np.mean(own / usual)) for one, own in noise.items()}
    return {one.name: one for one, k in times.items() if k <= MORE_THAN_NOISE}


def best_in_torques(fits: Fits) -> Judged:
    """The better one of a model at each joint by itself, and one with shared values.

    Torques are compared without replays, so that there is time to search both ways. The
    first is given up where it does not lead to the noise: no model is exact then, and
    many values would fit its errors.
    """
    detailed, common = each_joint(fits), pruned(fits, shared_first(fits))
    if not may_be_noise(fits, detailed):
        return common
    best = pruned(fits, shared(fits, detailed))
    return common if fits.ebic(best).prefers(common, best) else best


def may_be_noise(fits: Fits, best: Judged) -> bool:
    """Whether what a model leaves is so little that it may be noise."""
    floors = fits.fit.noise_energy, fits.judge.select.noise_energy
    left = best.fit.energy, best.selected
    return all(
        one <= MORE_THAN_NOISE**2 * floor
        for one, floor in zip(left, floors, strict=True)
    )
