"""Packages that import a public name only when it is first used."""

import importlib
from collections.abc import Callable, Iterable, Mapping
from typing import Any


def lazy_face(
    package: str, modules: Mapping[str, Iterable[str]]
) -> Callable[[str], Any]:
    """Make a package's `__getattr__` (PEP 562) that imports public names on first use.

    Importing the package, called `package`, then stays quick. `modules` holds the
    public names of each module, by its path relative to the package.

    Example:
      >>> __getattr__ = lazy_face(__name__, {"traces.trace": ["Trace"]})
    """
    homes = {name: module for module, names in modules.items() for name in names}

    def find(name: str) -> Any:
        if name not in homes:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        return getattr(importlib.import_module(f"{package}.{homes[name]}"), name)

    return find
