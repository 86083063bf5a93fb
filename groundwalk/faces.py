"""Packages that import a public name only when it is first used."""

import importlib
from collections.abc import Callable, Iterable, Mapping
from typing import Any


def lazy_face(
    package: str, modules: Mapping[str, Iterable[str]]
) -> Callable[[str], Any]:
    """Make the `__getattr__` of a package (PEP 562), so that importing it stays quick.

    Args:
      package: the package's `__name__`.
      modules: public names, by the module within the package that defines them.

    Example:
      >>> __getattr__ = lazy_face(__name__, {"traces.trace": ["Trace"]})
    """
    homes = {name: module for module, names in modules.items() for name in names}

    def find(name: str) -> Any:
        if name not in homes:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        return getattr(importlib.import_module(f"{package}.{homes[name]}"), name)

    return find
