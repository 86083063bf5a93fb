"""Sets of test cases with concealed physics: which cases there are.

How a case is written is the same for all sets (`written.py`).
"""

from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path

from experiments.concealed.case import first_case
from experiments.concealed.doctored.case import doctored_case
from experiments.concealed.identical import identical_case
from experiments.concealed.second.case import second_case
from experiments.concealed.written import MadeCase, case_name, write_case

CaseMaker = Callable[[int, int, int], MadeCase]
"""Function of a set's seed, the case's number and the number of cases that makes the
case."""

SETS: Mapping[int, CaseMaker] = {1: first_case, 2: second_case, 4: identical_case}
"""Makers of the simulated cases of each set, by its number (docs/concealed.md)."""
REAL_SET = 3
"""Number of the set whose cases are doctored real recordings."""


def make_case(
    which: int,
    cases: Path,
    truths: Path,
    seed: int,
    number: int,
    count: int,
    data: Path | None = None,
) -> None:
    """Make a test case of set number `which`, and write its truth and its folder.

    `cases` and `truths` are the folders of all cases and truths; `seed` and `count` are
    seed and number of cases of the set; `data` is the folder of real recordings, for
    doctored cases instead.
    """
    make = SETS[which] if data is None else partial(doctored_case, data)
    made = make(seed, number, count)
    write_case(cases, truths, case_name(number), made)
