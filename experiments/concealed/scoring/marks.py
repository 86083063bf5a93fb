"""Compares the answer (a verdict) to a test case with the effects hidden in it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from diagnosis.effects import all_effects
from diagnosis.verdict import Found, Verdict
from experiments.concealed.scoring.oracle import Oracle
from experiments.concealed.scoring.truth import TrueCase
from worlds.hidden.effects import Hidden

NAMED_KINDS = ("single", "pair", "triple")
"""Kinds of test cases whose hidden effects are known to the diagnosis and excited by
the motion."""

_BOUND = 1.0
"""Limit, in both directions, of the share of the error that an answer removes, so that
a single bad answer does not decide a mean."""


@dataclass(frozen=True)
class Mark:
    """The comparison of an answer (a verdict on a test case) with the truth.

    Attributes:
      case: the truth.
      level: level of difficulty, "L1" (easy) to "L4"; None if no effect that the
        diagnosis knows is hidden.
      kind: kind of the verdict, or "missing".
      names_something: whether any effect is named.
      top1: whether the verdict is "effects" and its first effect has a true name.
      in_set: whether a true name is among the `set_size` names that are considered.
      places: for each effect found with a true name, whether its place is true.
      hits: number of effects found that are true in name and place; `extra` are not.
      missed: number of true effects that were not found.
      errors: relative error of each effect that is true in name and place.
      covered: for each main parameter of these, whether its interval holds the truth.
      closed: held-out error that the answer removes, as a share of the error that the
        fitted true effects remove; None if they remove nothing. `wrong_place` and
        `wrong_effect` are the shares for the answer's controls.
      probability: stated probability of the first effect; None without an effect.
    """

    case: TrueCase
    level: str | None
    kind: str
    names_something: bool
    top1: bool
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

    @property
    def right(self) -> bool:
        """Whether exactly the hidden effects are named, at their places.

        For an effect that the diagnosis does not know any verdict but "effects" is
        right; if the joint never moves, also "none" and "not_identifiable".
        """
        exact = self.kind == "effects" and not self.extra and not self.missed
        match self.case.kind:
            case "none":
                return not self.names_something and self.kind != "missing"
            case "outside":
                return self.kind not in ("effects", "missing")
            case "unexcited":
                return exact or self.kind in ("none", "not_identifiable")
            case _:
                return exact


def mark(
    case: TrueCase, verdict: Verdict | None, oracle: Oracle | None, method: str
) -> Mark:
    """Compare a method's answer (None is wrong in every respect) with the truth.

    The oracle is None if no effect that the diagnosis knows is hidden.
    """
    found = verdict.effects if verdict else ()
    true = {_at(each): each for each in case.effects}
    names = {each.name for each in case.effects}
    considered = _considered(verdict) if verdict else set()
    keys = {_at(each) for each in found} & set(true)
    pairs = [(each, true[at]) for each in found for at in keys if at == _at(each)]
    named = verdict is not None and verdict.kind == "effects"
    closed = _closed(oracle, method) if oracle else None
    place, wrong = _controls(verdict, closed)
    return Mark(
        case=case,
        level=oracle.level if oracle else None,
        kind=verdict.kind if verdict else "missing",
        names_something=bool(found),
        top1=named and found[0].name in names,
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
        probability=found[0].probability if named else None,
    )


def _at(effect: Found | Hidden) -> tuple[str, str]:
    return effect.name, effect.place


def _considered(verdict: Verdict) -> set[str]:
    """Names of all effects that an answer finds or does not rule out."""
    found = {each.name for each in verdict.effects}
    others = {other.name for each in verdict.effects for other in each.confusable_with}
    answers = {each.name for answer in verdict.alternatives for each in answer}
    return found | others | answers


def _main(true: Hidden) -> list[str]:
    known = all_effects().get(true.name)
    names = (known and known.main_parameters) or tuple(true.parameters)
    return [name for name in names if name in true.parameters]


def _error(found: Found, true: Hidden, oracle: Oracle | None) -> float:
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


def _covered(found: Found, true: Hidden) -> list[bool]:
    stated = [(found.parameters.get(n), true.parameters[n]) for n in _main(true)]
    return [one is not None and one.low <= value <= one.high for one, value in stated]


def _closed(oracle: Oracle, method: str) -> float | None:
    """Held-out error removed by an answer, as a share of that by the true effects.

    From -1 to 1; 0 for an answer that is missing or names nothing; None in test cases
    that are too hard (levels L3, L4) or if the true effects remove nothing.
    """
    if oracle.level not in ("L1", "L2") or oracle.nominal <= oracle.fitted:
        return None
    _, error = oracle.answered.get(method, ("", oracle.nominal))
    return _bounded((oracle.nominal - error) / (oracle.nominal - oracle.fitted))


def _controls(
    verdict: Verdict | None, closed: float | None
) -> tuple[float | None, float | None]:
    """Shares of error removed by the controls at a wrong place and with a wrong effect.

    Each is `closed` times the ratio of the error that the control removes to the error
    that the replaced effect removes, from the held-out errors that the answer states;
    None if that effect removes nothing.
    """
    fit = verdict.fit if verdict else None
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
