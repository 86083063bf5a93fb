"""Action transformers, groundings by name, and the folders of transformers.

A new grounding is one new file in this folder. It registers its `Grounding` with
`add_grounding` and, if it defines a new class of transformer, that class with
`@file_kind`. All files of the folder are imported before the first look-up.
"""

import json
import pkgutil
from collections.abc import Mapping, Sequence
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Protocol, Self, TypeVar

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadModelError, BadValueError, UnknownNameError
from groundwalk.files import write_text

if TYPE_CHECKING:
    from sgat.transformers.grounding_base import Grounding


class Transformer(Protocol):
    """Stands between a policy and n robots of a world, and changes their actions.

    Example:
      >>> transformer = grounding("sgat").transformer(data)
      >>> transformer.reset(seeds)
      >>> changed = transformer(state, action)
    """

    def reset(self, seeds: Sequence[np.random.SeedSequence]) -> None:
        """Start an episode of n robots, each with its own seed."""

    def __call__(self, state: FloatArray, action: FloatArray) -> FloatArray:
        """(n, a) actions for the world, from states (n, s) and asked actions (n, a)."""


class KeptTransformer(Transformer, Protocol):
    """A transformer that can be written into a folder and read back.

    Attributes:
      kind: name of this class in the folder's header, by which the reader finds it.
    """

    kind: ClassVar[str]

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """(a,) least and (a,) largest action, in the action's units."""

    def save(self, folder: Path) -> dict[str, Any]:
        """Write the models into a folder; return what else `load` needs."""

    @classmethod
    def load(
        cls, folder: Path, header: Mapping[str, Any], low: FloatArray, high: FloatArray
    ) -> Self:
        """Read what `save` wrote; the least and largest action are (a,) each."""


T = TypeVar("T", bound=type[KeptTransformer])

_GROUNDINGS: dict[str, "Grounding"] = {}
_KINDS: dict[str, type[KeptTransformer]] = {}


def add_grounding(grounding: "Grounding") -> None:
    """Register a grounding, so that it can be looked up by its name and its title.

    Example:
      >>> add_grounding(ThroughModels("sgat-large", "SGAT, large", members=9))
    """
    if grounding.name in _GROUNDINGS:
        raise BadValueError(f"there is a grounding {grounding.name!r} already")
    _GROUNDINGS[grounding.name] = grounding


def groundings() -> dict[str, "Grounding"]:
    """All groundings by name.

    Example:
      >>> sorted(groundings())[:2]
      ['gat', 'sgat']
    """
    _import_shelf()
    return dict(_GROUNDINGS)


def grounding(name: str) -> "Grounding":
    """One grounding, looked up by its name or its title; else UnknownNameError.

    Example:
      >>> grounding("SGAT, uneven sim").name
      'sgat-uneven'
    """
    for one in groundings().values():
        if name in (one.name, one.title):
            return one
    raise UnknownNameError("grounding", name, groundings())


def file_kind(cls: T) -> T:
    """Class decorator: this class reads transformer folders of the kind `cls.kind`."""
    _KINDS[cls.kind] = cls
    return cls


@cache
def _import_shelf() -> None:
    """Import every file of this folder once, so that it registers what it defines."""
    package = __name__.rpartition(".")[0]
    for module in pkgutil.iter_modules(import_module(package).__path__):
        import_module(f"{package}.{module.name}")


HEADER = "transformer.json"
_FORMAT = 1


def write_transformer(folder: Path, transformer: KeptTransformer) -> None:
    """Write a transformer into a folder, which is made if it does not exist.

    BadValueError if it is not fitted, or has other noise than white noise.

    Example:
      See docs/python.md, "Learn with Gymnasium".
    """
    low, high = (bound.tolist() for bound in transformer.bounds)
    header: dict[str, Any] = {"format": _FORMAT, "low": low, "high": high}
    header |= {"kind": transformer.kind, **transformer.save(folder)}
    write_text(folder / HEADER, json.dumps(header, indent=1) + "\n")


def read_transformer(folder: Path) -> KeptTransformer:
    """Read a folder that `write_transformer` wrote; BadModelError if it holds none.

    The transformer gives the same actions as the one that was written, to the last bit.

    Example:
      >>> read_transformer(Path("runs/sgat")).bounds
    """
    try:
        header = json.loads((folder / HEADER).read_text())
        if header["format"] != _FORMAT:
            raise ValueError(f"its format is {header['format']}")
        low, high = np.array(header["low"], float), np.array(header["high"], float)
        kind = header["kind"]
        _import_shelf()
        if kind not in _KINDS:
            raise UnknownNameError("kind of transformer", kind, _KINDS)
        return _KINDS[kind].load(folder, header, low, high)
    except (OSError, KeyError, TypeError, ValueError, UnknownNameError) as error:
        raise BadModelError(f"{folder} holds no action transformer: {error}") from error
