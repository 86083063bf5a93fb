"""Sets of test cases with concealed physics: which cases there are.

How a case is written is the same for all sets (`written.py`).
"""

from collections.abc import Callable, Mapping
from pathlib import Path

from experiments.concealed.case import first_case
from experiments.concealed.second.case import second_case
from experiments.concealed.written import MadeCase, case_name, write_case

CaseMaker = Callable[[int, int, int], MadeCase]
"""Function of a set's seed, the case's number and the number of cases that makes the
case."""

SETS: Mapping[int, CaseMaker] = {1: first_case, 2: second_case}
"""Makers of the cases of each set, by the set's number (docs/concealed.md)."""


def make_case(
    which: int, cases: Path, truths: Path, seed: int, number: int, count: int
) -> None:
    """Make a test case of set number `which`, and write its truth and its folder.

    `cases` and `truths` are the folders of all cases and truths; `seed` and `count` are
    seed and number of cases of the set.
    """
    made = SETS[which](seed, number, count)
    write_case(cases, truths, case_name(number), made)
