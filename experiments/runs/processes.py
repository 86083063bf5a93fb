"""Distributes calls over worker processes, which are spawned, not forked."""

import contextlib
import os
import signal
from collections.abc import Iterator, Mapping
from concurrent.futures import Executor, Future, ProcessPoolExecutor, as_completed
from multiprocessing import get_context
from typing import TypeVar

Key = TypeVar("Key")
Result = TypeVar("Result")


@contextlib.contextmanager
def process_pool(processes: int, calls: int | None = None) -> Iterator[Executor]:
    """An executor of worker processes (0: one per core), closed after the `with` block.

    The processes are spawned, not forked, because PyBullet and MuJoCo keep state that
    no other process may inherit. Functions must therefore be defined at the top of a
    module; arguments and results are pickled. If the block ends by an error or Ctrl-C,
    calls that have not begun are cancelled. At most as many processes as `calls` are
    started.

    Example:
      >>> with process_pool(2) as pool:
      ...     calls = {n: pool.submit(math.factorial, n) for n in range(5)}
      ...     found = {n: call.result() for n, call in as_done(calls)}
    """
    workers = processes or os.cpu_count() or 1
    if calls is not None:
        workers = max(min(workers, calls), 1)
    with ProcessPoolExecutor(
        workers, mp_context=get_context("spawn"), initializer=_end_quietly
    ) as pool:
        try:
            yield pool
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def as_done(
    calls: Mapping[Key, "Future[Result]"],
) -> Iterator[tuple[Key, "Future[Result]"]]:
    """Yield each key and its submitted call, in the order in which the calls finish.

    Example:
      >>> calls = {seed: pool.submit(work, seed) for seed in (1, 2)}
      >>> results = {seed: call.result() for seed, call in as_done(calls)}
    """
    keys = {call: key for key, call in calls.items()}
    for call in as_completed(keys):
        yield keys[call], call


def _end_quietly() -> None:
    """Let Ctrl-C end a worker process silently: its parent process reports it."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
