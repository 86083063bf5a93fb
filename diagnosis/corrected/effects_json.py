"""Reads and writes `corrected.json`: effects that a diagnosis found, for simulation."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from diagnosis.effects.ground import has_ground_contact
from diagnosis.effects.library import effect
from diagnosis.effects.parts import PlacedEffect
from diagnosis.plant.plant import Base, Plant
from diagnosis.residuals.predictor import Model
from diagnosis.residuals.small_mismatch.usual_errors import is_usual
from diagnosis.verdict import Verdict
from groundwalk.errors import BadModelError, BadValueError, UnknownNameError
from groundwalk.json_data import from_plain, parse_object, to_plain

CORRECTED_JSON, DIAGNOSIS_JSON = "corrected.json", "diagnosis.json"
FORMAT = 1


@dataclass(frozen=True)
class Entry:
    """An effect in `corrected.json`: name, place, and values by name in SI units."""

    name: str
    place: str
    parameters: Mapping[str, float]


@dataclass(frozen=True)
class Correction:
    """The effects that correct a robot's nominal sim.

    Attributes:
      robot: name of the robot model.
      base: "fixed" or "floating", as it was in the recordings.
      native: effects that MuJoCo can simulate, which `corrected.xml` contains.
      per_tick: other effects, which a simulation has to compute at every step.
    """

    robot: str
    base: Base
    native: tuple[Entry, ...]
    per_tick: tuple[Entry, ...]

    @classmethod
    def of(cls, plant: Plant, model: Model) -> "Correction":
        """The correction with the effects and values of a fitted model of a robot."""
        parts = []
        for one in model:
            values = dict(zip(_parameters(plant, one), one.values, strict=True))
            parts.append(Entry(one.name, one.place, values))
        return cls(plant.name, plant.base, *_sorted(parts))

    @classmethod
    def of_verdict(cls, verdict: Verdict, robot: str, base: Base) -> "Correction":
        """The correction with a verdict's best estimates for a robot with a base."""
        parts = []
        for found in verdict.effects:
            values = {name: one.value for name, one in found.parameters.items()}
            parts.append(Entry(found.name, found.place, values))
        return cls(robot, base, *_sorted(parts))

    def to_json(self) -> str:
        """The correction as JSON text; equal corrections give equal text."""
        plain = {"format": FORMAT, **to_plain(self)}
        return json.dumps(plain, indent=1, allow_nan=False) + "\n"

    def model(self, plant: Plant) -> Model:
        """The effects with places and values, checked against a model of the robot.

        How level a base was mounted, if it was about level, is left out for a robot
        that walks.

        Raises:
          BadModelError: the effects belong to another robot, have other parameters, or
            cannot act on this robot model.
          UnknownNameError: the robot lacks a place, or an effect does not exist.
        """
        if self.robot != plant.name:
            raise BadModelError(
                f"these effects are of {self.robot!r}, the robot is {plant.name!r}"
            )
        parts = (*self.native, *self.per_tick)
        placed = (self._placed(plant, part) for part in parts)
        return tuple(one for one in placed if one is not None)

    def _placed(self, plant: Plant, part: Entry) -> PlacedEffect | None:
        """The effect with its values; None if it is usual, but not on this base."""
        obstacle = effect(part.name).obstacle(self.base, plant.base)
        placed = _checked(plant, part)
        if obstacle and is_usual(plant, placed):
            return None
        if obstacle:
            raise BadModelError(obstacle)
        return placed


def load_correction(source: str | Path, plant: Plant) -> Model:
    """Read the effects that a diagnosis found, for a sim of the same robot.

    The source is a folder that `groundwalk diagnose` has written, a `corrected.json`,
    or a `diagnosis.json`, for which the base is assumed to be fixed.

    Raises:
      BadModelError: the file is not from a diagnosis, or belongs to another robot.
      UnknownNameError: the file names an effect or a place that does not exist.
    """
    path = _file(Path(source))
    try:
        text = path.read_text()
        plain = parse_object(text, "correction", FORMAT)
        if "kind" in plain:
            verdict = Verdict.from_json(text)
            return Correction.of_verdict(verdict, plant.name, "fixed").model(plant)
        return from_plain(Correction, plain, "correction").model(plant)
    except (UnicodeDecodeError, BadValueError) as error:
        raise BadModelError(f"{path} is no diagnosis: {error}") from None
    except BadModelError as error:
        raise BadModelError(f"{path}: {error}") from None


def _file(source: Path) -> Path:
    if not source.is_dir():
        if source.is_file():
            return source
        raise BadModelError(f"{source}: no such folder or file")
    for name in (CORRECTED_JSON, DIAGNOSIS_JSON):
        if (source / name).is_file():
            return source / name
    raise BadModelError(
        f"{source} is no folder of a diagnosis: it has no {CORRECTED_JSON}"
    )


def _sorted(parts: Sequence[Entry]) -> tuple[tuple[Entry, ...], tuple[Entry, ...]]:
    """Divide effects into those that MuJoCo can simulate and the others."""
    native = tuple(part for part in parts if effect(part.name).native)
    return native, tuple(part for part in parts if not effect(part.name).native)


def _parameters(plant: Plant, placed: PlacedEffect | Entry) -> list[str]:
    every = effect(placed.name).parameters(plant, placed.place)
    return [parameter.name for parameter in every]


def _checked(plant: Plant, part: Entry) -> PlacedEffect:
    _check_place(plant, part)
    names = _parameters(plant, part)
    if sorted(names) != sorted(part.parameters):
        raise BadModelError(
            f"{part.name}@{part.place} has the parameters "
            f"{', '.join(part.parameters)}; it needs {', '.join(names)}"
        )
    values = tuple(part.parameters[name] for name in names)
    return PlacedEffect(part.name, part.place, values)


def _check_place(plant: Plant, part: Entry) -> None:
    kind = effect(part.name).place_kind
    places = {"joint": plant.joints, "body": [name for name in plant.bodies if name]}
    if kind == "feet" and not has_ground_contact(plant):
        raise BadModelError(f"{part.name} needs a robot that stands on a ground")
    known = places.get(kind, (kind,))
    if part.place not in known:
        raise UnknownNameError(f"{kind} of {plant.name}", part.place, known)
