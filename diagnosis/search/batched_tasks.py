"""Several fits side by side, whose questions are answered in one batch."""

import threading
from collections.abc import Callable, Sequence
from contextvars import copy_context
from typing import Generic, TypeVar

Question = TypeVar("Question")
Answer = TypeVar("Answer")
Result = TypeVar("Result")


class _Desk(Generic[Question, Answer]):
    """Where tasks leave their questions, and wait."""

    def __init__(self, tasks: int) -> None:
        self._condition = threading.Condition()
        self._busy = tasks
        self._asked: dict[int, Question] = {}
        self._answers: dict[int, Answer | BaseException] = {}

    def ask(self, task: int, question: Question) -> Answer:
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
        with self._condition:
            self._busy -= 1
            self._condition.notify_all()

    def questions(self) -> dict[int, Question]:
        """Of all tasks, once each of them waits or is done."""
        with self._condition:
            self._condition.wait_for(lambda: self._busy == 0)
            asked, self._asked = self._asked, {}
            self._busy = len(asked)
        # in the tasks' order: that of their threads is never the same twice
        return dict(sorted(asked.items()))

    def reply(self, answers: dict[int, Answer | BaseException]) -> None:
        with self._condition:
            self._answers.update(answers)
            self._condition.notify_all()


def lockstep(
    tasks: Sequence[Callable[[Callable[[Question], Answer]], Result]],
    answer: Callable[[list[Question]], list[Answer]],
) -> list[Result]:
    """Run tasks that ask questions, and answer those of all tasks together.

    Each task is an ordinary function, for example a fit by a library's optimiser, that
    is given a function to ask with. Whenever every task waits, `answer` is called once.

    Args:
      tasks: what to run.
      answer: answers to a list of questions, in its order.

    Returns:
      The tasks' results. What a task or `answer` raises is raised here.
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
