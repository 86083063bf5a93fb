"""Progress of long runs: a bar on a terminal, a few lines of text elsewhere."""

import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from typing import TYPE_CHECKING, Protocol, Self

if TYPE_CHECKING:
    from rich.progress import Progress, TaskID

LINES_PER_TASK = 10
"""Number of lines of progress that are printed for one task, outside of a terminal."""

LONG_S = 60.0
"""Expected duration of a run [s] from which it is announced before the run begins."""


class Task(Protocol):
    """A task whose progress is shown."""

    def advance(self, note: str = "", steps: int = 1) -> None:
        """Report that steps are done; the note says something about the last one."""


@contextmanager
def progress(title: str, steps: int, done: int = 0) -> Iterator[Task]:
    """Show the progress of a task on standard error, with the time left.

    `done` is the number of steps that an interrupted run has done before.

    Example:
      >>> with progress("trials", steps=10) as task:
      ...     for _ in range(10):
      ...         task.advance()
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
    """A progress bar of the library rich."""

    def __init__(self, bars: "Progress", bar: "TaskID") -> None:
        self._bars, self._bar = bars, bar

    def advance(self, note: str = "", steps: int = 1) -> None:
        self._bars.update(self._bar, advance=steps, note=note)


class _Lines:
    """Prints a line of text after each tenth of a task; used without a terminal."""

    def __init__(self, title: str, steps: int, done: int) -> None:
        self._title, self._steps, self._done = title, steps, done
        self._start_s, self._before = time.monotonic(), done

    def advance(self, note: str = "", steps: int = 1) -> None:
        every = max(1, self._steps // LINES_PER_TASK)
        lines, self._done = self._done // every, self._done + steps
        if self._done // every == lines and self._done != self._steps:
            return
        spent_s = time.monotonic() - self._start_s
        left_s = spent_s / (self._done - self._before) * (self._steps - self._done)
        line = f"{self._title} {self._done}/{self._steps}, {left_s:.0f} s left"
        print(f"{line}, {note}" if note else line, file=sys.stderr, flush=True)


class Stages:
    """Shows the progress of work in consecutive stages, each with its time left.

    `diagnosis.diagnose` takes it as its progress display. Use it in a `with` block.
    """

    def __init__(self, work: str, threads: int) -> None:
        """Prepare the display of `work` (its name), which runs in `threads` threads."""
        self._work, self._threads = work, max(threads, 1)
        self._open = ExitStack()
        self._task: Task | None = None
        self._left = 0

    def __enter__(self) -> Self:
        """Begin to show progress."""
        return self

    def __exit__(self, *failure: object) -> None:
        """Finish the last stage, unless an error ended it."""
        if failure[0] is None:
            self._finish()
        self._open.close()

    def cost(self, seconds: float) -> None:
        """Print the estimated duration of the work, if that is more than a minute."""
        if seconds > LONG_S:
            minutes = round(seconds / 60)
            spent = f"{minutes} minute{'s' * (minutes > 1)}"
            threads = f"{self._threads} thread{'s' * (self._threads > 1)}"
            line = f"{self._work}: about {spent} on {threads}"
            print(line, file=sys.stderr, flush=True)

    def stage(self, name: str, steps: int) -> None:
        """Finish the present stage and begin the next one, of about so many steps.

        With fewer steps the display ends early; with more it stays at 100 % until the
        next stage begins.
        """
        self._finish()
        self._left = max(steps, 1)
        self._task = self._open.enter_context(progress(name, self._left))

    def advance(self, steps: int = 1) -> None:
        """Report that steps of the present stage are done."""
        if self._task is not None and self._left > 0:
            self._task.advance(steps=min(steps, self._left))
            self._left -= min(steps, self._left)

    def _finish(self) -> None:
        self.advance(self._left)
        self._open.close()
        self._task = None
