"""Tasks side by side: as if alone, with their questions in common batches."""

import threading
import time

import numpy as np
import pytest
from scipy.optimize import least_squares, minimize_scalar

from diagnosis.search.batched_tasks import lockstep


class Oracle:
    """Squares numbers, and remembers the batches that they came in."""

    def __init__(self):
        self.batches = []

    def __call__(self, questions):
        self.batches.append(list(questions))
        return [question**2 for question in questions]


def asks(*numbers):
    """A task that asks for some squares and returns their sum."""
    return lambda ask: sum(ask(number) for number in numbers)


def test_tasks_get_the_answers_to_their_own_questions():
    oracle = Oracle()
    assert lockstep([asks(1, 2), asks(10, 20), asks(3, 4)], oracle) == [5, 500, 25]
    assert [sorted(batch) for batch in oracle.batches] == [[1, 3, 10], [2, 4, 20]]


def test_questions_come_in_the_tasks_order_whoever_asks_first():
    asking = threading.Event()

    def late(ask):
        asking.wait()
        time.sleep(0.05)
        return ask(1)

    def early(ask):
        asking.set()
        return ask(2)

    oracle = Oracle()
    assert lockstep([late, early], oracle) == [1, 4]
    assert oracle.batches == [[1, 2]]


def test_tasks_may_be_of_different_lengths():
    oracle = Oracle()
    tasks = [asks(1, 2, 3, 4), asks(), asks(5), asks(6, 7)]
    assert lockstep(tasks, oracle) == [30, 0, 25, 85]
    assert [len(batch) for batch in oracle.batches] == [3, 2, 1, 1]


def test_nothing_to_do():
    def never(questions):
        raise AssertionError("nobody asked")

    assert lockstep([], never) == []
    assert lockstep([lambda ask: "done"], never) == ["done"]


def test_optimisers_of_a_library_find_what_they_find_alone():
    """The function that asks may be called from deep inside."""

    def parabola(centre):
        return lambda ask: minimize_scalar(lambda x: ask((x, centre))).x

    def line(slope):
        times = np.arange(5.0)

        def fit(ask):
            wrong = [lambda x, t=t: ask((x[0] * t, slope * t)) ** 0.5 for t in times]
            return least_squares(lambda x: [one(x) for one in wrong], [0.1]).x[0]

        return fit

    def answer(questions):
        return [(x - c) ** 2 for x, c in questions]

    tasks = [parabola(3.0), line(2.0), parabola(-1.0)]
    together = lockstep(tasks, answer)
    assert together == [lockstep([task], answer)[0] for task in tasks]
    assert together[0] == pytest.approx(3.0)
    assert together[2] == pytest.approx(-1.0)


def test_many_tasks_many_questions():
    oracle = Oracle()
    tasks = [asks(*range(i, i + i % 7)) for i in range(60)]
    wanted = [sum(k**2 for k in range(i, i + i % 7)) for i in range(60)]
    assert lockstep(tasks, oracle) == wanted
    assert len(oracle.batches) == 6


def test_what_a_task_raises_is_raised_and_the_others_end():
    ended = []

    def fails(ask):
        ask(1)
        raise ZeroDivisionError("of the task")

    def works(ask):
        ended.append(ask(2) + ask(3) + ask(4))

    with pytest.raises(ZeroDivisionError, match="of the task"):
        lockstep([works, fails, works], Oracle())
    assert ended == [29, 29]


def test_what_the_answer_raises_is_raised():
    def answer(questions):
        raise ZeroDivisionError("of the answer")

    before = threading.active_count()
    with pytest.raises(ZeroDivisionError, match="of the answer"):
        lockstep([asks(1), asks(2)], answer)
    assert threading.active_count() == before


def test_a_task_may_live_with_an_answer_that_failed():
    def answer(questions):
        if -1 in questions:
            raise ValueError("negative")
        return questions

    def careful(ask):
        try:
            ask(-1)
        except ValueError:
            return ask(7)

    assert lockstep([careful], answer) == [7]


def test_too_few_answers_are_refused():
    before = threading.active_count()
    with pytest.raises(ValueError, match="zip"):
        lockstep([asks(1), asks(2)], lambda questions: [1])
    assert threading.active_count() == before
