import numpy as np
import pytest

from groundwalk.errors import BadValueError
from sgat.tabular.mdp import FiniteMdp


def coin(**changes):
    """One action: a fair coin decides between two ends."""
    values = {
        "transition": np.array([[[0, 0.5, 0.5]], [[0, 1, 0]], [[0, 0, 1]]]),
        "reward": np.array([0.0, 1.0, -1.0]),
        "ends": np.array([False, True, True]),
    }
    return FiniteMdp(**values | changes)


def test_size():
    assert (coin().states, coin().actions) == (3, 1)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"reward": np.zeros(2)}, "2 rewards"),
        ({"ends": np.zeros(4, bool)}, "4 ends"),
        ({"transition": np.full((3, 2, 2), 0.5)}, r"\(3, 2, 2\)"),
        ({"transition": np.full((3, 1, 3), 0.3)}, "add up to 1"),
        ({"transition": np.tile([1.5, -0.5, 0], (3, 1, 1))}, "add up to 1"),
        ({"start": 3}, "start is 3"),
        ({"start": -1}, "start is -1"),
    ],
)
def test_tables_that_are_no_world_are_refused(changes, message):
    with pytest.raises(BadValueError, match=message):
        coin(**changes)
