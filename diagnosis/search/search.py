"""The search for missing effects: it extends models and selects among them.

Models grow by one effect at a time, several of them side by side, because the best
single effect need not belong to the best pair. Linear estimates decide which models are
fitted, fits use the fitting data only, and the selection data decide whether an effect
is believed. `accept.py` tests the result further.
"""

import itertools
from collections.abc import Sequence

from diagnosis.effects.library import all_effects, effect
from diagnosis.residuals.bursts import push_intervals
from diagnosis.residuals.channels import MORE_THAN_NOISE
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.residuals.signatures import Signature, signatures
from diagnosis.residuals.torques.ripples import usage_of
from diagnosis.search.candidates import Candidates, grown, moved
from diagnosis.search.judging import Judge, distinct, gain_of_noise
from diagnosis.search.result import MOST_LEFT, Judged, SearchResult, keys_of
from diagnosis.search.spread import is_widespread

ONE_MORE = 0.5
"""Share of the energy above the noise beside a single effect that one more must promise
to explain; elsewhere effects are looked for at all joints at once."""


class Search:
    """One search for effects that explain the fitting and the selection data.

    Attributes:
      judge: fits and judges the models.
      signatures: changes of the residual by each effect at each place; filled by `run`.
      widespread: whether `run` ended early, since most joints are off beside what the
        best single effect explains.
    """

    def __init__(self, judge: Judge, promising: Sequence[Model] = ()) -> None:
        """Prepare a search; the predictors of `judge` must be calibrated already."""
        self.judge, self._promising = judge, promising
        self.signatures: list[Signature] = []
        self.widespread = False
        self._rules, self._fit = judge.rules, judge.fit
        self._usage = usage_of(judge.fit)

    def run(self, anyway: bool = False) -> SearchResult:
        """Add effects to models until another one does not improve them enough.

        It ends after a single effect if most joints are off beside it, unless it is
        to go on `anyway`.
        """
        judge = self.judge
        self.widespread = False
        intervals = push_intervals(self._bare, self._bare.residuals([()])[0])
        self.signatures = signatures(self._fit, (), self._usage, intervals)
        starts = Candidates(self._fit, self.signatures, self._rules)
        alone = self._with_promising(1, starts.alone(judge.residual))
        best = {1: self._round(1, alone)}
        chosen, size = 0, 1
        before: Judged | None = None
        while best.get(size):
            judge.least_gain = _by_chance(starts, best[size][0])
            believed = judge.believes(best[size][0], before)
            if believed:
                began = best[size][0].keys
                best[size] = self._refined(best[size])
                starts = self._starts_from(best[size][0])
                if best[size][0].keys != began:  # grown, and leaving less
                    judge.least_gain = _by_chance(starts, best[size][0])
            leader = best[size][0] if believed else None
            if size == 1 and not anyway and self._most_joints_are_off(leader, starts):
                self.widespread, chosen = True, int(believed)
                break
            if leader:
                chosen, before = size, leader
            # two effects together may explain what neither explains alone, such as
            # backlash and the friction that damps it
            elif size > chosen + 1 or not self._much_is_left(before):
                break
            larger = self._larger(starts, best[size])
            size += 1
            best[size] = self._round(size, self._with_promising(size, larger))
        if chosen and not self.widespread:
            replaced = starts.swapped(best[chosen][0])
            swapped = self._round(chosen, replaced, "replacements of ")
            best[chosen] = distinct(judge.ranked(best[chosen] + swapped))
        for smaller in range(1, chosen):  # beside small mismatch as the best has it
            some = best[smaller][: self._rules.compared]
            best[smaller] = judge.ranked(judge.again(some))
        # how much recordings differ by is learned of few, to a factor of two or so
        rough = MORE_THAN_NOISE**2 - 1 if self._fit.knows_healthy_torques else MOST_LEFT
        energies = judge.nothing_fit, judge.floor_fit
        own = *energies, rough, judge.correlated
        return SearchResult(judge.nothing, judge.floor, best, chosen, *own)

    @property
    def _bare(self) -> Predictor:
        """Without tolerances: whitened with them a short error is no longer short."""
        return self._fit.without_tolerances()

    def _most_joints_are_off(self, leader: Judged | None, starts: Candidates) -> bool:
        """Whether most joints are off beside a single effect that is believed, if any.

        They do not count as off if one more effect, such as a delay, promises to
        explain half of what is left; `starts` are candidates beside the single one.
        """
        model, few = leader.model if leader else (), self._rules.largest
        if not is_widespread(self._fit, model, few):
            return False
        if leader is None or few == 1:
            return True
        left = leader.fit.energy - self.judge.floor_fit
        return starts.promised(leader) < ONE_MORE * left

    @property
    def large(self) -> Model:
        """A promising model with more effects than are searched for; () for none."""
        most = self._rules.largest
        return next((one for one in self._promising if len(one) > most), ())

    def _with_promising(self, size: int, starts: list[Model]) -> list[Model]:
        """The models to start from, if any, and the promising ones of their size."""
        return [*starts, *(m for m in self._promising if len(m) == size)]

    def _much_is_left(self, best: Judged | None) -> bool:
        """Whether so much remains to be explained that pairs of effects are tried."""
        energy = best.selected if best else self.judge.nothing
        return energy >= self._rules.suspicious * self.judge.floor

    def _round(
        self, size: int, starts: Sequence[Model], kind: str = ""
    ) -> list[Judged]:
        """Fit and judge the models of one search round, and report its progress."""
        if starts:
            name = f"{kind}search round {size}"
            self.judge.hooks.stage(name, self.judge.replays_of(starts))
        return self.judge.judged(starts)

    def _starts_from(self, leader: Judged) -> Candidates:
        """Candidates beside a leading model, with pushes visible in its residual.

        Small mismatch of the nominal model was fitted anew beside it, and signatures
        are found anew as well.
        """
        lasting = [name for name, kind in all_effects().items() if not kind.timed]
        old = [one for one in self.signatures if effect(one.placed.name).timed]
        new = signatures(self._fit, leader.model, self._usage, names=lasting)
        self.signatures = [*new, *old]
        left = leader.fit.residual, self._bare.residuals([leader.model])[0]
        found = [push_intervals(self._fit, one)[1:] for one in left]
        bursts = list(dict.fromkeys(itertools.chain(*found)))
        pushes: list[Signature] = []
        if bursts:
            timed = [name for name, kind in all_effects().items() if kind.timed]
            pushes = signatures(self._fit, leader.model, self._usage, bursts, timed)
        return Candidates(self._fit, [*self.signatures, *pushes], self._rules)

    def _larger(self, starts: Candidates, best: Sequence[Judged]) -> list[Model]:
        """Models with one more effect; none if too little can be gained by them."""
        judge, leader = self.judge, best[0]
        alone = len(leader.model) == 1
        residual = judge.residual if alone else None
        if len(leader.model) == self._rules.largest:
            return []
        if leader.selected > self._rules.suspicious * judge.floor:
            larger = starts.larger(best, near=alone, residual=residual)
            if alone and not self._promising:
                larger += self._hidden_pairs(larger)
            return larger
        gain = starts.promised(leader) * judge.select.scored.sum()
        least = self._rules.promising * judge.least_gain * self._fit.scored.sum()
        if gain < least:
            return []
        return starts.larger(best, near=False, residual=residual)

    def _hidden_pairs(self, known: Sequence[Model]) -> list[Model]:
        """Pairs, beside those known, that explain most of the residual as it is.

        Two effects that nearly cancel each other leave little beyond tolerances, from
        which linear estimates do not tell which they are.
        """
        (left,) = self._bare.residuals([()])
        found = signatures(
            self._bare, (), self._usage, push_intervals(self._bare, left)
        )
        pairs = Candidates(self._bare, found, self._rules).pairs(left)
        keys = {keys_of(model) for model in known}
        return [model for model in pairs if keys_of(model) not in keys]

    def _refined(self, best: list[Judged]) -> list[Judged]:
        """Fit the best models again with the integration error of the best one.

        Dry friction and end stops change it. More general forms of the best model's
        effects are fitted as well, and those at the next bodies: beside a load at the
        wrong one small mismatch does not lead to the noise. Values and small mismatch
        beside them are fitted in turn, as long as more is gained than by chance.
        """
        judge = self.judge
        for _ in range(self._rules.refinements):
            before = best[0]
            judge.calibrate(before.model)
            first = best[: self._rules.beam]
            others = judge.again(best[self._rules.beam :])
            wider = [*grown(self._fit, before.model), *moved(self._fit, before.model)]
            models = [*(judged.model for judged in first), *wider]
            known = [None, *(judged.fit.jacobian for judged in first[1:])]
            tried = judge.judged(models, [*known, *(None for _ in wider)])
            best = distinct(judge.ranked([*tried, *others]))
            same = best[0].keys == before.keys or best[0] not in tried
            if same and best[0].energy > before.energy - judge.least_gain:
                break
        return best


def _by_chance(starts: Candidates, best: Judged) -> float:
    """Gain [nats] that no further effect reaches by chance beside the best model."""
    return max(starts.gain_by_chance(best.fit.residual), gain_of_noise(1))
