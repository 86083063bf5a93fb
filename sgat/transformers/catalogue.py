"""All groundings and all kinds of transformer files that this folder defines.

A new grounding is one new file in this folder. It registers its `Grounding` with
`add_grounding` and, if it brings an own class of transformer, that class with
`@file_kind`. All files of the folder are imported before the first look-up, so no list
needs another entry.
"""

import pkgutil
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING, TypeVar

from groundwalk.errors import BadValueError, UnknownNameError
from sgat.transformers.transformer import KeptTransformer

if TYPE_CHECKING:
    from sgat.transformers.grounding_base import Grounding

T = TypeVar("T", bound=type[KeptTransformer])

_GROUNDINGS: dict[str, "Grounding"] = {}
_KINDS: dict[str, type[KeptTransformer]] = {}


def add_grounding(grounding: "Grounding") -> None:
    """Make a grounding known by its name and by its title.

    Raises:
      BadValueError: another grounding has this name already.

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
    """One grounding, looked up by its name or its title.

    Raises:
      UnknownNameError: there is none; the message has the nearest name.

    Example:
      >>> grounding("SGAT, uneven sim").name
      'sgat-uneven'
    """
    for one in groundings().values():
        if name in (one.name, one.title):
            return one
    raise UnknownNameError("grounding", name, groundings())


def file_kind(cls: T) -> T:
    """Class decorator: folders whose header names `cls.kind` are read by this class.

    Example:
      See `sgat.transformers.direct_transformer.DirectTransformer`.
    """
    _KINDS[cls.kind] = cls
    return cls


def kind_of_file(kind: str) -> type[KeptTransformer]:
    """The class of transformers whose folders have this kind in their header.

    Raises:
      UnknownNameError: no class has registered it.
    """
    _import_shelf()
    if kind not in _KINDS:
        raise UnknownNameError("kind of transformer", kind, _KINDS)
    return _KINDS[kind]


@cache
def _import_shelf() -> None:
    """Import every file of this folder once: each registers what it defines."""
    package = __name__.rpartition(".")[0]
    for module in pkgutil.iter_modules(import_module(package).__path__):
        import_module(f"{package}.{module.name}")
