"""How right an answer to one concealed case is: everything that can be counted."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from diagnosis.corrected.effects_json import EffectValues
from diagnosis.verdict.verdict import Found, Verdict
from experiments.concealed.scoring.oracle import Oracle
from experiments.concealed.scoring.truth import TrueCase

NAMED_KINDS = ("single", "pair", "triple")
"""Cases in which something of the library is to be found."""

MAIN: Mapping[str, tuple[str, ...]] = {
    "stribeck_friction": ("coulomb_torque", "extra_torque"),
    "joint_elasticity": ("stiffness",),
    "joint_spring": ("stiffness",),
    "end_stop": ("angle",),
    "external_force": ("x", "y", "z"),
    "contact_compliance": ("stiffness",),
}
"""Parameters that say how large an effect is; all of them where it is not listed."""

_BOUND = 1.0


@dataclass(frozen=True)
class Mark:
    """One answer held against the truth.

    Attributes:
      case: the truth.
      level: by the oracle; None where nothing of the library is to be found.
      kind: of the verdict, or "missing".
      names_something: whether any effect is named.
      top1: whether the verdict is "effects" and its first effect has a true name.
      in_set: whether a true name is among all that the answer considers.
      set_size: how many names it considers.
      places: for each effect found with a true name, whether its place is true.
      hits: effects found that are true in name and place ...
      extra: ... that are not ...
      missed: ... and true effects that were not found.
      errors: relative error of each effect that is true in name and place.
      covered: for each of their main parameters, whether its interval holds the truth.
      closed: share of what the oracle closes that the answer closes; None where there
        is nothing to close.
      wrong_place: the same for the answer's own control at a wrong place.
      wrong_effect: the same for its control with a wrong effect.
      probability: of the first effect; None without one.
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
        """Whether the answer is right as a whole.

        All that is there is named, by name and place, and nothing else. Where nothing
        of the library is there, nothing is; where it is not excited, that may be said.
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
    """Hold an answer against the truth.

    Args:
      case: the truth.
      verdict: the answer; None is wrong in every respect.
      oracle: of the case; None where nothing of the library is to be found.
      method: whose answer it is.
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


def _at(effect: Found | EffectValues) -> tuple[str, str]:
    return effect.name, effect.place


def _considered(verdict: Verdict) -> set[str]:
    """All names that an answer does not rule out."""
    found = {each.name for each in verdict.effects}
    others = {other.name for each in verdict.effects for other in each.confusable_with}
    answers = {each.name for answer in verdict.alternatives for each in answer}
    return found | others | answers


def _main(found: Found, true: EffectValues) -> list[str]:
    names = MAIN.get(true.name, tuple(true.parameters))
    return [name for name in names if name in true.parameters]


def _error(found: Found, true: EffectValues, oracle: Oracle | None) -> float:
    """Distance of the estimate from the truth, over that of the truth from nothing.

    Main parameters together as a vector. Where nothing happens at infinity, as with a
    stiffness, the truth itself is the measure. A parameter that is not stated is as
    wrong as if nothing had been found.
    """
    key = f"{true.name}@{true.place}"
    neutral = oracle.neutral.get(key, {}) if oracle else {}
    wrong, size = [], []
    for name in _main(found, true):
        value, nothing = true.parameters[name], neutral.get(name) or 0.0
        stated = found.parameters.get(name)
        wrong.append((stated.value if stated else nothing) - value)
        size.append(value - nothing)
    return math.hypot(*wrong) / max(math.hypot(*size), 1e-12)


def _covered(found: Found, true: EffectValues) -> list[bool]:
    return [
        name in found.parameters
        and found.parameters[name].low
        <= true.parameters[name]
        <= found.parameters[name].high
        for name in _main(found, true)
    ]


def _closed(oracle: Oracle, method: str) -> float | None:
    """Within +-1; an answer that is not there, or names nothing, closes nothing."""
    if oracle.level not in ("L1", "L2") or oracle.nominal <= oracle.fitted:
        return None
    _, error = oracle.answered.get(method, ("", oracle.nominal))
    share = (oracle.nominal - error) / (oracle.nominal - oracle.fitted)
    return min(max(share, -_BOUND), _BOUND)


def _controls(
    verdict: Verdict | None, closed: float | None
) -> tuple[float | None, float | None]:
    """What the controls close, as a part of what the effect closes that they replace.

    From the answer's own held-out errors; an answer that closes nothing has none.
    """
    fit = verdict.fit if verdict else None
    if fit is None or closed is None:
        return None, None
    without = fit.nominal if fit.without is None else fit.without
    if fit.corrected >= without:
        return None, None

    def share(error: float | None) -> float | None:
        if error is None:
            return None
        part = closed * (without - error) / (without - fit.corrected)
        return min(max(part, -_BOUND), _BOUND)

    return share(fit.wrong_place), share(fit.wrong_effect)


def by_kind(marks: Sequence[Mark], *kinds: str) -> list[Mark]:
    """Marks of cases of some kinds."""
    return [each for each in marks if each.case.kind in kinds]
