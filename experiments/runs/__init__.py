"""Runs: folders, options, progress, worker processes, and steps that may fail.

A run folder holds the options of a run, its state and its results; a run that was
stopped is continued from it.
"""

from typing import TYPE_CHECKING

from groundwalk.faces import lazy_face

if TYPE_CHECKING:
    from experiments.runs.extras import extra
    from experiments.runs.folder import RunFolder, open_run
    from experiments.runs.options import RunOptions
    from experiments.runs.processes import as_done, process_pool

__all__ = [
    "RunFolder",
    "RunOptions",
    "as_done",
    "extra",
    "open_run",
    "process_pool",
]

__getattr__ = lazy_face(
    __name__,
    {
        "extras": ["extra"],
        "folder": ["RunFolder", "open_run"],
        "options": ["RunOptions"],
        "processes": ["as_done", "process_pool"],
    },
)
"""Imports a module of this package when one of its names is first used, so that
`groundwalk doctor` works without any installed package."""
