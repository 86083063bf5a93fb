"""Dataclasses as JSON and back."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
import pytest

from groundwalk.errors import BadValueError, GroundwalkError
from groundwalk.json_data import (
    NOT_IN_JSON,
    from_plain,
    parse_json,
    parse_object,
    to_plain,
)


@dataclass(frozen=True)
class Part:
    size_m: float
    count: int = 1

    def __post_init__(self):
        if self.count < 0:
            raise BadValueError("count is negative")


@dataclass(frozen=True)
class Whole:
    name: str
    kind: Literal["left", "right"] = "left"
    parts: Mapping[str, Part] = field(default_factory=dict)
    spans: tuple[tuple[float, float], ...] = ()
    pair: tuple[str, float | None] = ("none", None)
    file: Path | None = None
    names: Annotated[tuple[str, ...], "positional"] = ()
    free: float | int | tuple[float, float] = 0


FULL = Whole(
    "a",
    "right",
    {"left": Part(0.5, 2)},
    ((0.0, 1.0),),
    ("b", 2.0),
    Path("there"),
    ("x", "y"),
    3,
)
PLAIN = {
    "name": "a",
    "kind": "right",
    "parts": {"left": {"size_m": 0.5, "count": 2}},
    "spans": [[0.0, 1.0]],
    "pair": ["b", 2.0],
    "file": "there",
    "names": ["x", "y"],
    "free": 3,
}


def test_plain_values_make_the_same_dataclass_again():
    assert to_plain(FULL) == PLAIN
    assert from_plain(Whole, PLAIN, "whole") == FULL


def test_numbers_of_numpy_become_plain_floats():
    assert repr(to_plain(Part(np.float32(0.5)))) == "{'size_m': 0.5, 'count': 1}"
    assert repr(to_plain(Part(2))["size_m"]) == "2.0"


def test_keys_with_defaults_may_be_left_out_only_if_asked_for():
    assert from_plain(Whole, {"name": "a"}, "whole", complete=False) == Whole("a")
    with pytest.raises(BadValueError, match="whole has no 'kind'"):
        from_plain(Whole, {"name": "a"}, "whole")
    with pytest.raises(BadValueError, match="whole has no 'name'"):
        from_plain(Whole, {}, "whole", complete=False)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"kinds": 1}, "whole has an unknown key 'kinds': did you mean 'kind'?"),
        ({"name": 3}, "whole.name must be text, not 3"),
        ({"kind": "up"}, "whole.kind must be left or right, not 'up'"),
        ({"parts": []}, "whole.parts must be an object, not []"),
        ({"parts": {"a": {"count": 1}}}, "whole.parts.a has no 'size_m'"),
        (
            {"parts": {"a": {"size_m": True}}},
            "whole.parts.a.size_m must be a finite number, not True",
        ),
        (
            {"parts": {"a": {"size_m": 1, "count": 1.5}}},
            "whole.parts.a.count must be a whole number, not 1.5",
        ),
        (
            {"parts": {"a": {"size_m": 1, "count": -1}}},
            "whole.parts.a: count is negative",
        ),
        ({"spans": "ab"}, "whole.spans must be a list, not 'ab'"),
        ({"spans": [[0, 1], [2]]}, "whole.spans[1] must be a list of 2, not [2]"),
        ({"pair": ["a", "1"]}, "whole.pair[1] must be a finite number, not '1'"),
        ({"pair": ["a", 10**400]}, "whole.pair[1] must be a finite number"),
        ({"file": 3}, "whole.file must be text, not 3"),
        ({"names": [None]}, "whole.names[0] must be text, not None"),
    ],
)
def test_whatever_is_wrong_is_named_with_its_key_in_one_line(change, message):
    with pytest.raises(GroundwalkError) as caught:
        from_plain(Whole, {"name": "a", **change}, "whole", complete=False)
    assert str(caught.value).startswith(message)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("text", ["", "{", "NaN", "[" * 100_000, b"\xff\xfe\xfd"])
def test_text_that_is_no_json_is_refused(text):
    with pytest.raises(BadValueError, match="metadata is not JSON"):
        parse_json(text, "metadata")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[1]", "must be a JSON object"),
        ("{}", "has no 'format'"),
        ('{"format": 2}', "'format' is 2; only 1 is known"),
        ('{"format": true}', "'format' is True; only 1 is known"),
    ],
)
def test_an_object_has_the_format_that_is_known(text, message):
    with pytest.raises(BadValueError, match=message):
        parse_object(text, "metadata", 1)
    assert parse_object('{"format": 1, "a": 2}', "metadata", 1) == {"a": 2}


def test_fields_that_json_does_not_hold_are_left_out():
    @dataclass(frozen=True)
    class Part:
        name: str
        size: tuple[float, ...] = field(default=(), metadata=NOT_IN_JSON)

    assert to_plain(Part("a", (1.0,))) == {"name": "a"}
    assert from_plain(Part, {"name": "a"}, "part") == Part("a")
    with pytest.raises(BadValueError, match="unknown key 'size'"):
        from_plain(Part, {"name": "a", "size": []}, "part")
