"""Searches recordings for missing effects, again if they leave more than noise."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from diagnosis.conclude.answer import verdict_kind
from diagnosis.conclude.old_effects import old_effects, without
from diagnosis.conclude.soft_friction import CREEPS, creeps, rubs, softly
from diagnosis.material import Material
from diagnosis.plant.plant import Plant
from diagnosis.residuals.channels import MORE_THAN_NOISE, Channels
from diagnosis.residuals.data_sets import DataSets
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.residuals.reference_noise import ReferenceNoise
from diagnosis.residuals.small_mismatch.usual_errors import is_usual
from diagnosis.residuals.steps import precise
from diagnosis.residuals.timing.clock_at import clock_at
from diagnosis.residuals.trust import Trust, trust_of
from diagnosis.search.changes import established_changes, learn_torques
from diagnosis.search.few_or_many import found_by
from diagnosis.search.hooks import Hooks
from diagnosis.search.judging import Judge
from diagnosis.search.reference import learn_reference, reference_checks
from diagnosis.search.result import SearchResult, keys_of
from diagnosis.search.rules import Rules
from diagnosis.search.search import Search
from diagnosis.traces.trace import asked
from diagnosis.verdict import VerdictKind
from groundwalk.arrays import FloatArray

MORE_FLOATING = 4
"""Number of models that the search fits in addition if the base floats. Contacts make
the linear estimates unreliable by which it chooses models to fit."""

OTHER_NOISE = 1.1
"""Factor by which noise must differ for another search: from thousands of rows it is
known to some percent, and a tenth moves what counts as evidence by a fifth."""

MOST_KNOWN = 2
"""Most times that it is learned what the healthy robot has: before the search, and
after one that has found more of it. Where its model is far from exact it has several
explanations, and each further time it may change to another one, which explains what is
new as well."""

MOST_BESIDE, SETTLED = 5, 0.02
"""Most times that differences between recordings are learned beside what has changed,
and largest change of its values, as a share, at which that ends."""

FIT_REPLAYS = 150
"""Rough number of replays of the recordings in sim before the search; it only scales
the progress display."""


@dataclass(frozen=True, eq=False)
class Learned:
    """What a search found in recordings that were divided by use.

    Attributes:
      material: the recordings, and the robot model that was taken.
      data: predictors of the recordings, by use.
      noise: model errors that recordings of the healthy robot show, or None.
      search: the search, which has ended.
      result: what it found.
      kind: the kind of verdict that follows from that.
      everywhere: whether the result has effects at many joints.
      inexact: whether what these leave is more than noise, and counts as noise: no
        model of this robot is exact.
    """

    material: Material
    data: DataSets
    noise: ReferenceNoise | None
    search: Search
    result: SearchResult
    kind: VerdictKind
    everywhere: bool
    inexact: bool = False

    @classmethod
    def of(
        cls, material: Material, rules: Rules | None, threads: int, hooks: Hooks
    ) -> "Learned":
        """Search, and search again if the best model leaves much more than noise.

        What it leaves is then the noise: no model of this robot is better, and only
        what stands out from it is evidence. (A search for effects at all joints has
        taken it as noise by itself, so that only tests follow.) It also searches again
        where the best model shows other noise than the nominal one did, and if dry
        friction that lets joints creep fits better than such that stops them.
        """
        traces = (*material.traces, *material.reference)
        channels = precise(material.plant, traces, material.channels, threads)
        given = _rules(material.plant, rules)
        first = cls._of(material, channels, given, threads, hooks)
        if first.noise and first.noise.healthy:
            return first._beside_changes(channels, given, threads, hooks)
        timed = first._timed_anew()
        if timed is not None:
            channels = timed
            first = first._again(material, channels, given, threads, hooks)
        if first._creeps():
            material = _softened(material)
            first = first._again(material, channels, given, threads, hooks)
        if first.noise:
            return first
        return first._over_noise(channels, given, threads, hooks)

    def _again(
        self,
        material: Material,
        channels: Channels,
        rules: Rules,
        threads: int,
        hooks: Hooks,
    ) -> "Learned":
        """Another search, which also tries the best models of this one."""
        found = _best_of_each_size(self.search, self.result)
        return self._of(material, channels, rules.again, threads, hooks, found)

    def _over_noise(
        self, channels: Channels, rules: Rules, threads: int, hooks: Hooks
    ) -> "Learned":
        """With noise that is as large as what the best model leaves, if that is more.

        Where effects are everywhere, recordings in which more is left weigh less.
        """
        left = _left(self.data.learned, self.result)
        wider = np.maximum(left, 1 / channels.wider)
        if max(wider.max(), 1 / wider.min()) <= MORE_THAN_NOISE:
            return self
        material, wide = self.material, channels.widened(wider)
        if not self.everywhere:
            return self._again(material, wide, rules, threads, hooks)
        model = self.result.winner.model if self.result.winner else ()
        trust = trust_of([self.data.learned.squares_in(model)])
        data, *_ = _divided(material, wide, rules, threads, hooks, trust=trust)
        return replace(self, data=data, inexact=True)

    def _beside_changes(
        self, channels: Channels, rules: Rules, threads: int, hooks: Hooks
    ) -> "Learned":
        """A search beside differences between recordings that do not hold the change.

        At first they are learned as if nothing had changed, and so are too large. If
        nothing is found beside these, what is found beside those of the healthy robot's
        recordings alone is tried.
        """
        material, found = self.material, self
        if self.result.winner is None:
            found = self._of(material, channels, rules, threads, hooks, beside=None)
        sets = material.before, material.reference, (material.plant, material.traces)
        judge = self.search.judge

        def least(one: Model) -> float:
            return judge.least_gain + judge.price(one)

        for _ in range(MOST_BESIDE):
            before = found.result.winner
            if before is None:
                return self._less_all()
            model = established_changes(*sets, channels, before.model, least)
            if not model:
                return self._less_all()
            options = replace(rules.again, largest=len(model)), threads, hooks, [model]
            found = self._of(material, channels, *options, beside=model)
            winner = found.result.winner
            if winner is not None and _settled(before.model, winner.model):
                break
        return found if found.result.winner else self._less_all()

    def _less_all(self) -> "Learned":
        """This search, as if it had found nothing."""
        winner, material = self.result.winner, self.material
        if winner is None:
            return self
        result = without(self.search.judge, self.result, winner.model)
        kind = verdict_kind(result, material.plant, material.audited)
        return replace(self, result=result, kind=kind)

    def _timed_anew(self) -> Channels | None:
        """The channels as the best model shows their noise; None if that is no other.

        Recordings of the healthy robot have shown it before.
        """
        fit, winner = self.search.judge.fit, self.result.winner
        is_fixed = fit.plant.base == "fixed"
        if winner is None or self.noise or fit.by_torque or not is_fixed:
            return None
        timed, is_far_off = clock_at(fit, winner.model, fit.channels.untimed)
        other = timed.noise / fit.channels.noise
        differs = max(other.max(), 1 / other.min()) > OTHER_NOISE
        return timed if differs and not is_far_off else None

    def _creeps(self) -> bool:
        """Whether dry friction that lets joints creep fits better."""
        model = self.result.winner.model if self.result.winner else ()
        learned = self.data.learned
        if learned.by_torque or not rubs(learned.plant, model):
            return False
        return creeps(learned, model, self.search.judge.least_gain)

    @classmethod
    def _of(
        cls,
        material: Material,
        channels: Channels,
        rules: Rules,
        threads: int,
        hooks: Hooks,
        promising: Sequence[Model] = (),
        beside: Model | None = (),
    ) -> "Learned":
        """A search, which also tries the models `promising`.

        Where it finds what the healthy robot had as well, that becomes part of the
        nominal model, and it begins anew. What comes out again is left out.
        """
        known: Model | None = None
        for number in range(MOST_KNOWN):
            data, noise, search = _divided(
                material, channels, rules, threads, hooks, promising, known, beside
            )
            result, everywhere = found_by(search)
            old = old_effects(search.judge, result)
            before = _not_small(material.plant, noise, known)
            more = keys_of(old) - keys_of(before)
            if not more or number + 1 == MOST_KNOWN:
                break
            known = (*before, *(one for one in old if one.key in more))
            promising = [
                tuple(one for one in model if one.key not in more)
                for model in _best_of_each_size(search, result)
            ]
            rules = rules.again
        result = without(search.judge, result, old)
        kind = verdict_kind(result, material.plant, material.audited)
        everywhere = everywhere and result.chosen > 0
        return cls(material, data, noise, search, result, kind, everywhere)


def _softened(material: Material) -> Material:
    """The material with dry friction that lets joints creep."""
    plant, before = softly(material.plant), softly(material.before)
    limits = (*material.limits, CREEPS)
    return replace(material, plant=plant, before=before, limits=limits)


def _settled(before: Model, after: Model) -> bool:
    """Whether two models have the same effects with nearly the same values."""
    known = {one.key: np.array(one.values) for one in before}
    return keys_of(before) == keys_of(after) and all(
        np.allclose(known[one.key], one.values, rtol=SETTLED, atol=1e-9)
        for one in after
    )


def _not_small(
    plant: Plant, noise: ReferenceNoise | None, known: Model | None
) -> Model:
    """The effects of the healthy robot whose size is free when its model is learned.

    They are larger than usual errors of models, or were `known` before. All others are
    held to be small.
    """
    keys = keys_of(known or ())
    every = noise.model if noise else ()
    return tuple(one for one in every if one.key in keys or not is_usual(plant, one))


def _left(learned: Predictor, result: SearchResult) -> FloatArray:
    """(c,) rms of what the best model leaves in each channel, in units of noise.

    The median over blocks of time, since an event that is not explained is no noise.
    """
    model = result.winner.model if result.winner else ()
    (left,) = learned.residuals([model])
    scored = learned.scored
    blocks = int(learned.block.max()) + 1
    rms = []
    for channel in range(len(learned.channels.names)):
        own = scored & (learned.channel == channel)
        sums = np.bincount(learned.block[own], left[own] ** 2, blocks)
        counts = np.bincount(learned.block[own], minlength=blocks)
        some = counts > 0
        rms.append(np.sqrt(np.median(sums[some] / counts[some])) if some.any() else 0.0)
    return np.array(rms)


def _divided(
    material: Material,
    channels: Channels,
    rules: Rules,
    threads: int,
    hooks: Hooks,
    promising: Sequence[Model] = (),
    known: Model | None = None,
    beside: Model | None = (),
    trust: Trust | None = None,
) -> tuple[DataSets, ReferenceNoise | None, Search]:
    """The data by use, the healthy robot's model errors, and a search ready to run.

    The search also tries the models `promising`. The healthy robot has `known` effects,
    which are searched for if None. Recordings have the weights `trust`, by default 1.
    """
    plant, before, reference = material.plant, material.before, material.reference
    noise, healthy = None, list[Predictor]()
    if reference:
        options = rules, threads, hooks, known
        if asked(reference):
            noise = learn_torques(
                before, reference, (plant, material.traces), channels, beside
            )
        else:
            noise = learn_reference(before, reference, channels, *options)
    hooks.stage("fit", FIT_REPLAYS)
    own = plant, material.traces, channels, noise, threads, hooks.advance
    data = DataSets.of(*own, trust=trust)
    if noise:
        healthy = reference_checks(before, reference, channels, noise, threads, hooks)
    judge = Judge(data.fit, data.select, rules, healthy, hooks)
    return data, noise, Search(judge, promising)


def _best_of_each_size(search: Search, result: SearchResult) -> list[Model]:
    """The best models of each size that a search can try, and one with many effects."""
    rules = search.judge.rules
    found = [
        one.model
        for size, models in result.best.items()
        if size <= rules.largest
        for one in models[: rules.beam]
    ]
    if result.chosen > rules.largest and result.winner:
        found.append(result.winner.model)
    return found


def _rules(plant: Plant, rules: Rules | None) -> Rules:
    """Settings of a search, the default ones for None; a floating base fits more."""
    rules = rules or Rules()
    if plant.base == "fixed":
        return rules
    return replace(
        rules,
        single_effects=rules.single_effects + MORE_FLOATING,
        further_effects=rules.further_effects + MORE_FLOATING,
    )
