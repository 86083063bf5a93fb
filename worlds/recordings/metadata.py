"""What a recording says about itself, besides its columns."""

import json
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from numbers import Real
from typing import cast

from groundwalk.errors import BadRecordingError, BadValueError
from groundwalk.json_data import from_plain, parse_object, to_plain

FORMAT = 1
_BASES = ("fixed", "floating")
_REQUIRED = ("robot", "base", "source")


@dataclass(frozen=True)
class ServoGains:
    """The law by which a joint follows its command: kp * error - kd * velocity."""

    kp: float
    """Stiffness [N m/rad; N/m for a sliding joint]."""
    kd: float
    """Damping [N m s/rad; N s/m for a sliding joint]."""
    max_torque: float
    """Largest torque [N m; a force in N for a sliding joint]."""

    def __post_init__(self) -> None:
        """Check the gains and turn them into floats."""
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
    """How a recording words what was walked on: enough to make a terrain again."""

    name: str
    parameters: Mapping[str, object] = field(default_factory=dict)
    seed: int = 0

    def __post_init__(self) -> None:
        """Refuse a negative seed."""
        if self.seed < 0:
            raise BadValueError(f"seed must be from 0 up, not {self.seed}")


@dataclass(frozen=True)
class RecordingMetadata:
    """Where a recording comes from; the JSON of format 1.

    The optional parts are None (or empty) where they are not known. Everything is
    kept as JSON would give it back: lists for tuples, text for keys.
    """

    robot: str
    """Name of a description, or a model file."""
    base: str
    """How the base is held: "fixed" or "floating"."""
    source: str
    """Free text: who or what made the recording."""
    servo: Mapping[str, ServoGains] = field(default_factory=dict)
    """Gains by joint, for the joints of which they are known."""
    terrain: Mapping[str, object] | None = None
    """What was walked on: `name` of a terrain, its `parameters` and its `seed`."""
    gait: Mapping[str, object] | None = None
    """The gait parameters by name."""
    world: str | None = None
    """The world that was recorded: "sim", "real" or another word."""
    end: str | None = None
    """Why the rollout ended, as a world words it."""

    def __post_init__(self) -> None:
        """Check everything and copy what could be changed from outside.

        Raises:
          BadRecordingError: a part is of the wrong kind.
        """
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
        _check_servo(self.servo)
        object.__setattr__(self, "servo", dict(self.servo))
        for key in ("terrain", "gait"):
            value = getattr(self, key)
            if value is not None:
                object.__setattr__(self, key, _json_object(key, value))
        if self.terrain is not None:
            _check_terrain(self.terrain)

    def to_json(self) -> str:
        """The metadata as JSON text; the same metadata gives the same text."""
        plain = to_plain(self)
        plain["servo"] = plain["servo"] or None
        known = {key: part for key, part in plain.items() if part is not None}
        return json.dumps({"format": FORMAT, **known}, sort_keys=True)

    @classmethod
    def from_json(cls, text: str | bytes) -> "RecordingMetadata":
        """Read what `to_json` or another writer of format 1 has written.

        Args:
          text: JSON; a key with the value null counts as left out.

        Raises:
          BadRecordingError: it is no JSON, of another format, or a part is missing,
            unknown or of the wrong kind.
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


def _check_servo(servo: Mapping[str, ServoGains]) -> None:
    for joint, gains in _as_object("metadata 'servo'", servo).items():
        if not isinstance(gains, ServoGains):
            raise BadRecordingError(f"servo of {joint!r} must be gains, not {gains!r}")


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
