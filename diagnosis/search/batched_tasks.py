"""Runs several optimisers side by side and computes their residuals in batches.

SciPy's optimisers ask for one residual after another. Each runs in a thread that waits
for its answer, so that the residuals of all of them can be computed in one batch.
"""

import threading
from collections.abc import Callable, Sequence
from contextvars import copy_context
from queue import SimpleQueue
from typing import Any, TypeVar

Question = TypeVar("Question")
Answer = TypeVar("Answer")
Result = TypeVar("Result")


def lockstep(
    tasks: Sequence[Callable[[Callable[[Question], Answer]], Result]],
    answer: Callable[[list[Question]], list[Answer]],
) -> list[Result]:
    """Run tasks that ask questions, and answer the questions of all tasks together.

    A task is called with a function to ask with. Whenever all tasks wait, `answer` is
    called once; it returns the answers to a list of questions, in their order. Returns
    the results of the tasks; raises the exception of the first one that fails, or that
    of `answer`.
    """
    asked: SimpleQueue[tuple[int, list[Question]]] = SimpleQueue()
    replies: list[SimpleQueue[Any]] = [SimpleQueue() for _ in tasks]
    results: dict[int, Result] = {}
    failures: list[BaseException] = []

    def ask(number: int, question: Question) -> Answer:
        asked.put((number, [question]))
        reply = replies[number].get()
        if isinstance(reply, BaseException):
            raise reply
        answered: Answer = reply
        return answered

    def run(number: int) -> None:
        try:
            results[number] = tasks[number](lambda question: ask(number, question))
        except BaseException as failure:
            failures.append(failure)
        finally:
            asked.put((number, []))  # has ended

    for i in range(len(tasks)):
        # each thread in a copy of this context, in which a user's effects are known
        context = copy_context()
        threading.Thread(target=context.run, args=(run, i), daemon=True).start()
    busy = len(tasks)
    while busy:
        # in the order of the tasks, since that of their threads differs between runs
        messages = sorted((asked.get() for _ in range(busy)), key=lambda one: one[0])
        waiting = [number for number, question in messages if question]
        questions = [one for _, question in messages for one in question]
        busy = len(waiting)
        try:
            given: list[Any] = answer(questions) if busy else []
            answers = dict(zip(waiting, given, strict=True))
        except BaseException as failure:
            answers = dict.fromkeys(waiting, failure)
        for number in waiting:
            replies[number].put(answers[number])
    if failures:
        raise failures[0]
    return [results[i] for i in range(len(tasks))]
