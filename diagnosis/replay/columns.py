"""The joints' columns in arrays of MuJoCo."""

from collections.abc import Sequence

Columns = slice | list[int]
"""Index of the joints' columns in an array of MuJoCo."""


def columns(numbers: Sequence[int]) -> Columns:
    """Index of these columns: a slice if possible, since that avoids copies."""
    first, count = numbers[0], len(numbers)
    if list(numbers) == list(range(first, first + count)):
        return slice(first, first + count)
    return list(numbers)
