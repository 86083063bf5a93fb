"""Metadata of a recording: robot, base and source, and known servo gains and loads."""

import json
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from numbers import Real
from typing import cast

from groundwalk.errors import BadRecordingError, BadValueError
from groundwalk.json_data import from_plain, parse_object, to_plain
from worlds.recordings.load import Load

FORMAT = 1
_BASES = ("fixed", "floating")
_REQUIRED = ("robot", "base", "source")
_GAINS = ("kp", "kd", "max_torque")


@dataclass(frozen=True)
class ServoGains:
    """Gains of a joint's position servo.

    Its torque is clip(kp * error - kd * velocity, +-max_torque) - back_emf * velocity,
    error being command less position.

    Example:
      >>> ServoGains(kp=20.0, kd=0.5, max_torque=3.0).kp
      20.0
    """

    kp: float
    """Stiffness of the servo [N m/rad; N/m for a sliding joint]."""
    kd: float
    """Damping of the servo [N m s/rad; N s/m for a sliding joint]."""
    max_torque: float
    """Largest torque of the servo [N m; N for a sliding joint]; above 0."""
    back_emf: float = 0.0
    """Damping by the motor's back-EMF [N m s/rad], which no torque limit cuts."""
    armature: float = 0.0
    """Rotor inertia times the squared gear ratio [kg m^2; kg for a sliding joint]: a
    joint gets it whose model states none. 0 if unknown."""

    def __post_init__(self) -> None:
        """Check that the gains are finite and not negative; turn them into floats."""
        for item in fields(self):
            value = getattr(self, item.name)
            number = isinstance(value, Real) and not isinstance(value, bool)
            if not (number and 0.0 <= value <= sys.float_info.max):
                raise BadRecordingError(
                    f"servo {item.name} must be a number from 0 up, not {value!r}"
                )
            object.__setattr__(self, item.name, float(value))
        if self.max_torque == 0.0:
            raise BadRecordingError("servo max_torque must be above 0")


@dataclass(frozen=True)
class _Terrain:
    """Schema of the metadata `terrain`: enough to make the same terrain again."""

    name: str
    parameters: Mapping[str, object] = field(default_factory=dict)
    seed: int = 0

    def __post_init__(self) -> None:
        """Refuse a negative seed."""
        if self.seed < 0:
            raise BadValueError(f"seed must be from 0 up, not {self.seed}")


@dataclass(frozen=True)
class RecordingMetadata:
    """Metadata of a recording, stored as JSON beside its columns.

    Optional fields are None (or empty) if unknown. Values are kept as they would be
    read back from JSON: tuples become lists, keys text.

    Example:
      >>> RecordingMetadata("pendulum.xml", base="fixed", source="in water").base
      'fixed'
    """

    robot: str
    """Name of the robot, such as "nao", or a model file."""
    base: str
    """How the base is held: "fixed" or "floating"."""
    source: str
    """Free text: the person, robot or program that made the recording."""
    servo: Mapping[str, ServoGains] = field(default_factory=dict)
    """Servo gains by joint name; joints whose gains are unknown are left out."""
    loads: Mapping[str, Load] = field(default_factory=dict)
    """Loads that the robot carried beyond what its model has, by the body's name."""
    terrain: Mapping[str, object] | None = None
    """The terrain under the robot: its `name`, `parameters` and `seed`."""
    gait: Mapping[str, object] | None = None
    """The gait's parameters by name."""
    world: str | None = None
    """The world that was recorded: "sim", "real" or free text."""
    end: str | None = None
    """Why the rollout ended, such as "fall" or "left the ground"."""

    def __post_init__(self) -> None:
        """Check all fields; copy the mappings, so that later changes do not matter."""
        for key in ("robot", "base", "source", "world", "end"):
            value = getattr(self, key)
            if not isinstance(value, str) and (key in _REQUIRED or value is not None):
                raise BadRecordingError(f"metadata {key!r} must be text, not {value!r}")
        if not self.robot:
            raise BadRecordingError("metadata 'robot' is empty")
        if self.base not in _BASES:
            raise BadRecordingError(
                f"metadata 'base' must be 'fixed' or 'floating', not {self.base!r}"
            )
        for key, kind, name in (("servo", ServoGains, "gains"), ("loads", Load, "one")):
            _check_each(key, getattr(self, key), kind, name)
            object.__setattr__(self, key, dict(getattr(self, key)))
        for key in ("terrain", "gait"):
            value = getattr(self, key)
            if value is not None:
                object.__setattr__(self, key, _json_object(key, value))
        if self.terrain is not None:
            _check_terrain(self.terrain)

    def to_json(self) -> str:
        """The metadata as JSON text, with sorted keys; unknown fields are left out."""
        plain = to_plain(self)
        plain["servo"] = {
            joint: {
                key: value for key, value in gains.items() if value or key in _GAINS
            }
            for joint, gains in plain["servo"].items()
        } or None
        plain["loads"] = plain["loads"] or None
        known = {key: part for key, part in plain.items() if part is not None}
        return json.dumps({"format": FORMAT, **known}, sort_keys=True)

    @classmethod
    def from_json(cls, text: str | bytes) -> "RecordingMetadata":
        """Read metadata from a JSON object of format 1; a key that is null is left out.

        BadRecordingError if a key is missing, unknown or has a wrong value.
        """
        try:
            plain = parse_object(text, "metadata", FORMAT)
            known = {key: value for key, value in plain.items() if value is not None}
            return from_plain(cls, known, "metadata", complete=False)
        except BadValueError as error:
            raise BadRecordingError(str(error)) from None


def _as_object(what: str, value: object) -> dict[str, object]:
    if not isinstance(value, Mapping):
        raise BadRecordingError(f"{what} must be a JSON object, not {value!r}")
    return dict(value)


def _check_each(key: str, given: Mapping[str, object], kind: type, name: str) -> None:
    for place, one in _as_object(f"metadata {key!r}", given).items():
        if not isinstance(one, kind):
            raise BadRecordingError(f"{key} of {place!r} must be {name}, not {one!r}")


def _json_object(key: str, value: object) -> dict[str, object]:
    what = f"metadata {key!r}"
    try:
        copy = json.loads(json.dumps(_as_object(what, value), allow_nan=False))
    except (TypeError, ValueError, RecursionError) as error:
        raise BadRecordingError(f"{what} is not JSON: {error}") from error
    return cast("dict[str, object]", copy)


def _check_terrain(terrain: Mapping[str, object]) -> None:
    try:
        from_plain(_Terrain, dict(terrain), "metadata.terrain", complete=False)
    except BadValueError as error:
        raise BadRecordingError(str(error)) from None
