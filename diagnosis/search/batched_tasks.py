"""Runs several optimisers side by side and computes their residuals in batches.

SciPy's optimisers ask for one residual after another. Each runs in a thread that waits
for its answer, so that the residuals of all of them can be computed in one batch.
"""

import threading
from collections.abc import Callable, Sequence
from contextvars import copy_context
from typing import Generic, TypeVar

Question = TypeVar("Question")
Answer = TypeVar("Answer")
Result = TypeVar("Result")


class _Desk(Generic[Question, Answer]):
    """Passes questions from tasks in threads to the caller, and answers back."""

    def __init__(self, tasks: int) -> None:
        self._condition = threading.Condition()
        self._busy = tasks
        self._asked: dict[int, Question] = {}
        self._answers: dict[int, Answer | BaseException] = {}

    def ask(self, task: int, question: Question) -> Answer:
        """Leave a task's question and wait for its answer."""
        with self._condition:
            self._asked[task] = question
            self._busy -= 1
            self._condition.notify_all()
            self._condition.wait_for(lambda: task in self._answers)
            answer = self._answers.pop(task)
        if isinstance(answer, BaseException):
            raise answer
        return answer

    def done(self) -> None:
        """Note that a task has ended."""
        with self._condition:
            self._busy -= 1
            self._condition.notify_all()

    def questions(self) -> dict[int, Question]:
        """Questions by task number, once each task waits for an answer or has ended."""
        with self._condition:
            self._condition.wait_for(lambda: self._busy == 0)
            asked, self._asked = self._asked, {}
            self._busy = len(asked)
        # in the order of the tasks, since that of their threads differs between runs
        return dict(sorted(asked.items()))

    def reply(self, answers: dict[int, Answer | BaseException]) -> None:
        """Wake the waiting tasks with their answers."""
        with self._condition:
            self._answers.update(answers)
            self._condition.notify_all()


def lockstep(
    tasks: Sequence[Callable[[Callable[[Question], Answer]], Result]],
    answer: Callable[[list[Question]], list[Answer]],
) -> list[Result]:
    """Run tasks that ask questions, and answer the questions of all tasks together.

    A task is a function, for example a fit by an optimiser of SciPy, that is called
    with a function to ask with. Whenever all tasks wait, `answer` is called once.

    Args:
      tasks: functions of one argument, the function to ask with.
      answer: returns the answers to a list of questions, in their order.

    Returns:
      The results of the tasks, in their order.

    Raises:
      Exception: the exception of the first failing task, or that of `answer`.
    """
    desk: _Desk[Question, Answer] = _Desk(len(tasks))
    results: dict[int, Result] = {}
    failures: list[BaseException] = []

    def run(number: int) -> None:
        try:
            results[number] = tasks[number](lambda asked: desk.ask(number, asked))
        except BaseException as failure:
            failures.append(failure)
        finally:
            desk.done()

    threads = [
        # each thread in a copy of this context, in which a user's effects are known
        threading.Thread(target=copy_context().run, args=(run, i), daemon=True)
        for i in range(len(tasks))
    ]
    for thread in threads:
        thread.start()
    while asked := desk.questions():
        answers: dict[int, Answer | BaseException] = {}
        try:
            answers.update(zip(asked, answer(list(asked.values())), strict=True))
        except BaseException as failure:
            answers.update(dict.fromkeys(asked, failure))
        desk.reply(answers)
    for thread in threads:
        thread.join()
    if failures:
        raise failures[0]
    return [results[i] for i in range(len(tasks))]
