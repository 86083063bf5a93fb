"""A hidden effect with place and values, and the list of all kinds of effects."""

import importlib
import math
import pkgutil
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from groundwalk.errors import BadValueError, UnknownNameError
from worlds.hidden.effects.kind import HiddenKind, Quantity, Surroundings
from worlds.hidden.setting import Setting


def _found() -> Iterator[HiddenKind]:
    """An object of each subclass of `HiddenKind` in the modules of this package."""
    for module in pkgutil.iter_modules([str(Path(__file__).parent)]):
        name = f"{__package__}.{module.name}"
        if name in (__name__, HiddenKind.__module__):
            continue
        for value in vars(importlib.import_module(name)).values():
            if not (isinstance(value, type) and issubclass(value, HiddenKind)):
                continue
            if value.__module__ == name and hasattr(value, "name"):
                yield value()


KINDS: Mapping[str, HiddenKind] = {
    kind.name: kind for kind in sorted(_found(), key=lambda one: (one.rank, one.name))
}
"""All kinds of hidden physics by name, in the order from which test cases are drawn.

Example:
  >>> KINDS["backlash"].parameters["gap"].unit
  'rad'
"""


@dataclass(frozen=True)
class Hidden:
    """A hidden effect at its place, such as 0.02 rad of play in the left knee.

    The name is a key of `KINDS`; the place is that of a joint or body, or the kind's
    only one, such as "gyroscope". Parameters are in SI units; optional ones may be
    missing.

    Example:
      >>> Hidden("backlash", "LKneePitch", {"gap": 0.02}).to_text()
      'backlash@LKneePitch:gap=0.02'
    """

    name: str
    place: str
    parameters: Mapping[str, float]

    def __post_init__(self) -> None:
        """Refuse unknown names, and values that are missing or make no sense."""
        if self.name not in KINDS:
            raise UnknownNameError("effect", self.name, KINDS)
        known = self.kind.parameters
        for name in self.parameters:
            if name not in known:
                raise UnknownNameError(f"parameter of {self.name}", name, known)
        for name, quantity in known.items():
            if name in self.parameters:
                self._check(quantity, float(self.parameters[name]))
            elif quantity.default is None:
                raise BadValueError(f"{self.name} needs a value of {name}")
        own = self.kind.place
        if own not in ("joint", "body") and self.place != own:
            raise BadValueError(
                f"{self.name} belongs to {own!r}, not to {self.place!r}"
            )

    def _check(self, quantity: Quantity, value: float) -> None:
        about = f"{self.name}: {quantity.name} is"
        if not math.isfinite(value):
            raise BadValueError(f"{about} {value}")
        if not quantity.low <= value <= quantity.high:
            sensible = f"sensible values are {quantity.range_text}"
            raise BadValueError(f"{about} {value:g} {quantity.unit}; {sensible}")

    @property
    def kind(self) -> HiddenKind:
        """The kind of this effect, which has its physics, units and place."""
        return KINDS[self.name]

    @property
    def values(self) -> dict[str, float]:
        """Value of every parameter, optional ones included."""
        return {name: self[name] for name in self.kind.parameters}

    def __getitem__(self, parameter: str) -> float:
        """Value of a parameter in SI units; NaN where its default is not a number."""
        if parameter in self.parameters:
            return float(self.parameters[parameter])
        default = self.kind.parameters[parameter].default
        return math.nan if default is None else default

    def to_text(self) -> str:
        """The effect as text `name@place:parameter=value,...`, which `parse` reads."""
        values = ",".join(f"{key}={value:g}" for key, value in self.parameters.items())
        return f"{self.name}@{self.place}:{values}"

    @classmethod
    def parse(cls, text: str) -> "Hidden":
        """Read an effect from text `name@place:parameter=value,...`."""
        head, _, tail = text.partition(":")
        name, at, place = head.partition("@")
        if name not in KINDS:
            raise UnknownNameError("effect", name, KINDS)
        if not at and KINDS[name].place in ("joint", "body"):
            where = f"{name}@PLACE:parameter=value"
            raise BadValueError(f"{text}: say where, as in {where}")
        values = {}
        for item in filter(None, tail.split(",")):
            key, _, number = item.partition("=")
            try:
                values[key] = float(number)
            except ValueError:
                wrong = f"{text}: {item!r} must be parameter=number"
                raise BadValueError(wrong) from None
        return cls(name, place or KINDS[name].place, values)

    @classmethod
    def sized(cls, name: str, setting: Setting) -> "Hidden":
        """Draw an effect for a test case, at the setting's spot and of its ease."""
        kind = KINDS[name]
        joint, body = setting.plant.joints[setting.joint], setting.spot.body
        at = {"joint": joint, "body": body}.get(kind.place, kind.place)
        return cls(name, at, kind.size(setting))


def surroundings(effects: Iterable[Hidden]) -> Surroundings:
    """Signal delays, gyroscope bias and ground of a robot with these hidden effects.

    Example:
      >>> surroundings([Hidden.parse("ground_slope:pitch=0.1,roll=0")]).pitch_rad
      0.1
    """
    changed = Surroundings()
    for effect in effects:
        effect.kind.change_surroundings(changed, effect.values)
    return changed
