"""Look-up of all groundings, and of all transformer classes that have files.

A new grounding is one new file in this folder. It registers its `Grounding` with
`add_grounding` and, if it defines a new class of transformer, that class with
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
    """Register a grounding, so that it can be looked up by its name and its title.

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
      UnknownNameError: there is no such grounding; the message has the nearest name.

    Example:
      >>> grounding("SGAT, uneven sim").name
      'sgat-uneven'
    """
    for one in groundings().values():
        if name in (one.name, one.title):
            return one
    raise UnknownNameError("grounding", name, groundings())


def file_kind(cls: T) -> T:
    """Class decorator: this class reads transformer folders of the kind `cls.kind`.

    Example:
      See `sgat.transformers.direct_transformer.DirectTransformer`.
    """
    _KINDS[cls.kind] = cls
    return cls


def kind_of_file(kind: str) -> type[KeptTransformer]:
    """The transformer class that reads folders whose header names this kind.

    Raises:
      UnknownNameError: no class has registered this kind.
    """
    _import_shelf()
    if kind not in _KINDS:
        raise UnknownNameError("kind of transformer", kind, _KINDS)
    return _KINDS[kind]


@cache
def _import_shelf() -> None:
    """Import every file of this folder once, so that it registers what it defines."""
    package = __name__.rpartition(".")[0]
    for module in pkgutil.iter_modules(import_module(package).__path__):
        import_module(f"{package}.{module.name}")
