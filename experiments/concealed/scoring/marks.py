"""Compares the answer to a test case with the effects hidden in it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from diagnosis.effects import all_effects
from experiments.concealed.scoring.answers import Answer, Named
from experiments.concealed.scoring.oracle import Oracle
from experiments.concealed.scoring.truth import REAL, TrueCase, TrueEffect
from experiments.concealed.size_by_information import level_of

NAMED_KINDS = ("single", "pair", "triple")
"""Kinds of test cases whose hidden effects are known to the diagnosis and excited by
the motion."""

_CLEAR = ("L1", "L2")
"""Levels of difficulty at which an answer must see that something is there."""

_BOUND = 1.0
"""Limit, in both directions, of the share of the error that an answer removes, so that
a single bad answer does not decide a mean."""


@dataclass(frozen=True)
class Mark:
    """The comparison of an answer (to a test case) with the truth.

    Effects are named only by an answer of the kind "effects": those that another one
    lists are guesses. Named small mismatch that is really there counts nowhere.

    Attributes:
      case: the truth.
      level: level of difficulty, "L1" (easy) to "L4", that of the faintest effect; None
        if nothing is hidden, or set 1 hides what the diagnosis does not know.
      kind: kind of the answer, or "missing".
      names_something: whether any effect is named.
      top1: whether the first named effect has a true name; `there` whether it has a
        true place with it.
      in_set: whether a true name is among the `set_size` names that are considered.
      places: for each named effect with a true name, whether its place is true.
      hits: number of named effects that are true in name and place; `extra` are not.
      missed: number of true effects that were not named.
      errors: relative error of each effect that is true in name and place.
      covered: for each main parameter of these, whether its interval holds the truth.
      closed: held-out error that the answer removes, as a share of the error that the
        fitted true effects remove; None if they remove nothing, and in cases that are
        too hard (levels L3, L4). `wrong_place` and
        `wrong_effect` are the shares for the answer's controls.
      probability: stated probability of the first named effect; None without one.
      tells_why: whether the recordings are refused with the right words.
    """

    case: TrueCase
    level: str | None
    kind: str
    names_something: bool
    top1: bool
    there: bool
    in_set: bool
    set_size: int
    places: tuple[bool, ...]
    hits: int
    extra: int
    missed: int
    errors: tuple[float, ...]
    covered: tuple[bool, ...]
    closed: float | None
    wrong_place: float | None
    wrong_effect: float | None
    probability: float | None
    tells_why: bool = False

    @property
    def right(self) -> bool:
        """Whether exactly the hidden effects are named, at their places.

        Where nothing is hidden, nothing may be named, and the answer must say so. An
        effect that the diagnosis does not know makes "unknown" right, and "none" where
        it hardly shows; in real recordings "not_identifiable", or a refusal that tells
        why, instead. If the joint never moves, "none" and "not_identifiable" are right,
        too.
        """
        exact = self.kind == "effects" and not self.extra and not self.missed
        nothing = self.kind in ("none", "effects") and not self.names_something
        match self.case.kind:
            case "none":
                return nothing
            case "outside":
                said = self.kind == "unknown" or self.tells_why
                if self.case.engine == REAL:
                    said |= self.kind == "not_identifiable"
                return said or (self.level not in _CLEAR and nothing)
            case "unexcited":
                return exact or self.kind in ("none", "not_identifiable")
            case _:
                return exact


def mark(
    case: TrueCase, answer: Answer | None, oracle: Oracle | None, method: str
) -> Mark:
    """Compare a method's answer (None is wrong in every respect) with the truth.

    The oracle is None if no effect that the diagnosis knows is hidden.
    """
    found = _named(answer, case) if answer else []
    true = {_at(each): each for each in case.effects}
    names = {each.name for each in case.effects}
    considered = _considered(answer) if answer else set()
    keys = {_at(each) for each in found} & set(true)
    pairs = [(each, true[at]) for each in found for at in keys if at == _at(each)]
    level = case_level(case, oracle)
    closed = _closed(oracle, method) if oracle and level in _CLEAR else None
    place, wrong = _controls(answer, closed)
    return Mark(
        case=case,
        level=level,
        kind=answer.kind if answer else "missing",
        names_something=bool(found),
        top1=bool(found) and found[0].name in names,
        there=bool(found) and _at(found[0]) in true,
        in_set=bool(considered & names),
        set_size=len(considered),
        places=tuple(_at(each) in true for each in found if each.name in names),
        hits=len(keys),
        extra=len(found) - len(pairs),
        missed=len(true) - len(keys),
        errors=tuple(_error(*pair, oracle) for pair in pairs),
        covered=tuple(inside for pair in pairs for inside in _covered(*pair)),
        closed=closed,
        wrong_place=place,
        wrong_effect=wrong,
        probability=found[0].probability if found else None,
        tells_why=bool(answer and _tells_why(answer, case)),
    )


def case_level(case: TrueCase, oracle: Oracle | None) -> str | None:
    """Level of difficulty: by the information in the truth, else the oracle's."""
    if case.nats:
        return level_of(min(case.nats))
    return oracle.level if oracle else None


def _named(answer: Answer, case: TrueCase) -> list[Named]:
    """The effects that an answer names, without small mismatch that is there."""
    if answer.kind != "effects":
        return []
    return [each for each in answer.effects if not _is_small_mismatch(each, case)]


def _tells_why(answer: Answer, case: TrueCase) -> bool:
    """Whether an answer refuses recordings in words that the truth asks for."""
    if answer.kind != "refused" or not case.refusal:
        return False
    return any(all(word in text for word in case.refusal) for text in answer.limits)


def _is_small_mismatch(found: Named, case: TrueCase) -> bool:
    """Whether a named effect is small mismatch, and nearer to it than nothing is.

    A factor does nothing at 1, all else at 0.
    """
    for small in case.nuisance:
        if (small.name, small.place) != _at(found):
            continue
        nothing = {name: float(name == "factor") for name in small.parameters}
        values = {
            name: found.parameters[name].value if name in found.parameters else none
            for name, none in nothing.items()
        }
        wrong = [values[name] - small.parameters[name] for name in values]
        size = [nothing[name] - small.parameters[name] for name in values]
        return math.hypot(*wrong) <= math.hypot(*size)
    return False


def _at(effect: Named | TrueEffect) -> tuple[str, str]:
    return effect.name, effect.place


def _considered(answer: Answer) -> set[str]:
    """Names of all effects that an answer lists or does not rule out."""
    found = {each.name for each in answer.effects}
    others = {other.name for each in answer.effects for other in each.confusable_with}
    sets = {each.name for some in answer.alternatives for each in some}
    return found | others | sets


def _main(true: TrueEffect) -> list[str]:
    known = all_effects().get(true.name)
    names = (known and known.main_parameters) or tuple(true.parameters)
    return [name for name in names if name in true.parameters]


def _error(found: Named, true: TrueEffect, oracle: Oracle | None) -> float:
    """Error of the main parameters, relative to the size of the true effect.

    The error is the distance from the estimate to the truth, the size is that from the
    truth to the values at which the effect does nothing; an infinite one of these
    counts as zero. It also stands for a parameter that the answer does not state.
    """
    key = f"{true.name}@{true.place}"
    neutral = oracle.neutral.get(key, {}) if oracle else {}
    wrong, size = [], []
    for name in _main(true):
        value, nothing = true.parameters[name], neutral.get(name) or 0.0
        stated = found.parameters.get(name)
        wrong.append((stated.value if stated else nothing) - value)
        size.append(value - nothing)
    return math.hypot(*wrong) / max(math.hypot(*size), 1e-12)


def _covered(found: Named, true: TrueEffect) -> list[bool]:
    stated = [(found.parameters.get(n), true.parameters[n]) for n in _main(true)]
    return [one is not None and one.holds(value) for one, value in stated]


def _closed(oracle: Oracle, method: str) -> float | None:
    """Held-out error removed by an answer, as a share of that by the true effects.

    From -1 to 1; 0 for an answer that is missing or names nothing; None if the true
    effects remove nothing.
    """
    if oracle.nominal <= oracle.fitted:
        return None
    _, error = oracle.answered.get(method, ("", oracle.nominal))
    return _bounded((oracle.nominal - error) / (oracle.nominal - oracle.fitted))


def _controls(
    answer: Answer | None, closed: float | None
) -> tuple[float | None, float | None]:
    """Shares of error removed by the controls at a wrong place and with a wrong effect.

    Each is `closed` times the ratio of the error that the control removes to the error
    that the replaced effect removes, from the held-out errors that the answer states;
    None if that effect removes nothing.
    """
    fit = answer.fit if answer else None
    if fit is None or closed is None:
        return None, None
    without = fit.nominal if fit.without is None else fit.without
    removed = without - fit.corrected
    if removed <= 0:
        return None, None
    place, wrong = (
        None if error is None else _bounded(closed * (without - error) / removed)
        for error in (fit.wrong_place, fit.wrong_effect)
    )
    return place, wrong


def _bounded(share: float) -> float:
    """A share of the error, limited so that no single answer decides a mean."""
    return min(max(share, -_BOUND), _BOUND)


def by_kind(marks: Sequence[Mark], *kinds: str) -> list[Mark]:
    """Select the marks (comparisons with the truth) of test cases of some kinds."""
    return [each for each in marks if each.case.kind in kinds]
