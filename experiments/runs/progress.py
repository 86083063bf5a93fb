"""How far a long run is: a bar on a terminal, quiet lines elsewhere."""

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from rich.progress import Progress, TaskID

_LINES_PER_TASK = 10


class Task(Protocol):
    """One long piece of work."""

    def advance(self, note: str = "") -> None:
        """One step is done; the note says how it went."""


@contextmanager
def progress(title: str, steps: int, done: int = 0) -> Iterator[Task]:
    """Show a piece of work on standard error while it runs.

    Args:
      title: what it is.
      steps: how many steps it has.
      done: how many of them are done already.
    """
    if sys.stderr.isatty():
        from rich.console import Console
        from rich.progress import (
            BarColumn,
            MofNCompleteColumn,
            Progress,
            TextColumn,
            TimeRemainingColumn,
        )

        columns = (
            TextColumn("{task.description}"),
            BarColumn(),
            MofNCompleteColumn(),
            TimeRemainingColumn(),
            TextColumn("{task.fields[note]}"),
        )
        with Progress(*columns, console=Console(stderr=True)) as bars:
            bar = bars.add_task(title, total=steps, completed=done, note="")
            yield _Bar(bars, bar)
    else:
        yield _Lines(title, steps, done)


class _Bar:
    """A bar of rich."""

    def __init__(self, bars: "Progress", bar: "TaskID") -> None:
        self._bars, self._bar = bars, bar

    def advance(self, note: str = "") -> None:
        self._bars.update(self._bar, advance=1, note=note)


class _Lines:
    """A line for each tenth of the work."""

    def __init__(self, title: str, steps: int, done: int) -> None:
        self._title, self._steps, self._done = title, steps, done
        self._start_s, self._before = time.monotonic(), done

    def advance(self, note: str = "") -> None:
        self._done += 1
        every = max(1, self._steps // _LINES_PER_TASK)
        if self._done % every and self._done != self._steps:
            return
        spent_s = time.monotonic() - self._start_s
        left_s = spent_s / (self._done - self._before) * (self._steps - self._done)
        line = f"{self._title} {self._done}/{self._steps}, {left_s:.0f} s left"
        print(f"{line}, {note}" if note else line, file=sys.stderr, flush=True)
