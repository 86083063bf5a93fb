"""Interfaces by which a long diagnosis reports its progress and stores its results.

Both are optional: a `Progress` receives reports while a diagnosis runs, a `Checkpoint`
lets it go on after an interruption.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol, TypeVar

from groundwalk.arrays import FloatArray

Result = TypeVar("Result")


class Progress(Protocol):
    """Receives reports from a running diagnosis.

    Example:
      >>> class Printed:
      ...     def cost(self, seconds): print(f"about {seconds:.0f} s")
      ...     def stage(self, name, steps): print(name)
      ...     def advance(self, steps): pass
      >>> diagnose(plant, traces, seed, hooks=Hooks(progress=Printed()))
    """

    def cost(self, seconds: float) -> None:
        """Called once, before the first long stage, with the expected duration [s]."""

    def stage(self, name: str, steps: int) -> None:
        """Called when a stage of the diagnosis begins.

        Args:
          name: name of the stage, for example "search round 2".
          steps: rough number of simulations of the recordings in this stage.
        """

    def advance(self, steps: int) -> None:
        """Called after each batch with its number of simulations of the recordings."""


@dataclass(frozen=True, eq=False)
class Saved:
    """A result in a form that files can hold without pickle.

    Attributes:
      plain: values that JSON can hold.
      arrays: arrays of any shape, by name.
    """

    plain: Any
    arrays: Mapping[str, FloatArray] = field(default_factory=dict)


class Checkpoint(Protocol):
    """Stores the results of long stages, so that a diagnosis can be resumed."""

    def load(self, key: str) -> Saved | None:
        """The result that was saved under a key; None if there is none."""

    def save(self, key: str, saved: Saved) -> None:
        """Store a result under a key, a short name that suits a file."""


class Hooks:
    """The progress display and the checkpoint of one diagnosis.

    Example:
      >>> diagnose(plant, traces, seed, hooks=Hooks(checkpoint=my_store))
    """

    def __init__(
        self,
        progress: Progress | None = None,
        checkpoint: Checkpoint | None = None,
        part: str = "",
    ) -> None:
        """Connect a diagnosis with a progress display and a checkpoint, if any.

        `part` names a part of the diagnosis; it is put before the names of its stages
        and the keys of its results.
        """
        self.progress, self._checkpoint, self._part = progress, checkpoint, part
        self._saved, self._parts = 0, dict[str, int]()

    def within(self, part: str) -> "Hooks":
        """Hooks for a named part of the diagnosis, such as "reference".

        A part that comes again has a number, so that its results are stored apart.
        """
        self._parts[part] = self._parts.get(part, 0) + 1
        number = f" {self._parts[part]}" if self._parts[part] > 1 else ""
        return Hooks(self.progress, self._checkpoint, f"{part}{number}")

    def stage(self, name: str, steps: int) -> None:
        """Report that a stage with about `steps` simulations of the data begins."""
        if self.progress is not None:
            self.progress.stage(f"{self._part} {name}".strip(), steps)

    def advance(self, steps: int) -> None:
        """Report that `steps` more simulations of the recordings are done."""
        if self.progress is not None:
            self.progress.advance(steps)

    def saved(
        self,
        work: Callable[[], Result],
        pack: Callable[[Result], Saved],
        unpack: Callable[[Saved], Result],
    ) -> Result:
        """The result of some work, from the checkpoint if an earlier run stored it.

        Results are numbered in the order of the calls. A diagnosis is deterministic, so
        a resumed one makes the same calls in the same order. `pack` makes a result
        storable, `unpack` restores it.
        """
        if self._checkpoint is None:
            return work()
        part = self._part.replace(" ", "-") or "search"
        key = f"{part}-{self._saved:03d}"
        self._saved += 1
        stored = self._checkpoint.load(key)
        if stored is not None:
            return unpack(stored)
        result = work()
        self._checkpoint.save(key, pack(result))
        return result
