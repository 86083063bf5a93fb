"""Which columns of a simulation's arrays belong to the joints."""

from collections.abc import Sequence

Columns = slice | list[int]


def columns(numbers: Sequence[int]) -> Columns:
    """A slice where numbers follow one another, since views cost nothing.

    Args:
      numbers: of columns, in the order of the joints.
    """
    first, count = numbers[0], len(numbers)
    if list(numbers) == list(range(first, first + count)):
        return slice(first, first + count)
    return list(numbers)
