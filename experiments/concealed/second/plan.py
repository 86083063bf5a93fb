"""The plan of set 2: what each case is, dealt by count and not by chance.

Each property is dealt over the cases on its own, so that none tells of another: neither
tick rate nor robot says whether anything is hidden.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import TypeVar

import numpy as np

Key = TypeVar("Key")

KINDS_2 = {"single": 0.40, "pair": 0.15, "triple": 0.08, "none": 0.21, "outside": 0.16}
"""Share of the test cases of each kind: one, two, three or no hidden effects, or one
that a diagnosis does not know ("outside"). All have the small mismatch."""
ROBOTS = {
    "so101": 0.16,
    "two_dof": 0.12,
    "double_pendulum": 0.10,
    "z1": 0.08,
    "ur5": 0.08,
    "kinova": 0.08,
    "panda": 0.06,
    "xarm7": 0.06,
    "a1_leg": 0.08,
    "go2_leg": 0.08,
    "solo_leg": 0.10,
}
"""Share of the test cases for each robot, a limb of `worlds.hidden.limbs`."""
RATES_HZ = {30: 0.10, 50: 0.15, 100: 0.25, 200: 0.15, 250: 0.15, 500: 0.10, 1000: 0.10}
"""Share of the test cases for each tick rate [Hz]."""
DRIVES = {"servos": 0.84, "torques": 0.16}
"""Share of the test cases whose servos' gains and commands are known, and of those with
measured torques instead and an unknown controller."""
GAINS = {1: 2 / 3, 2: 1 / 3}
"""Share of the test cases by the number of servo gains in their recordings."""
REFERENCES = {True: 1 / 3, False: 2 / 3}
"""Share of the test cases with and without recordings of the healthy robot."""
ENGINES_2 = {"bullet": 0.5, "mujoco": 0.5}
"""Share of the test cases for each physics engine."""


@dataclass(frozen=True)
class CasePlan:
    """What one case of set 2 is: a key of each of this file's tables."""

    kind: str
    robot: str
    rate_hz: int
    drive: str
    gains: int
    reference: bool
    engine: str


@cache
def planned(seed: int, count: int) -> tuple[CasePlan, ...]:
    """The plans of all cases of a set with this seed and number of cases."""

    def column(number: int, table: Mapping[Key, float]) -> list[Key]:
        return dealt(table, count, np.random.default_rng([seed, count, number]))

    columns = (
        column(0, KINDS_2),
        column(1, ROBOTS),
        column(2, RATES_HZ),
        column(3, DRIVES),
        column(4, GAINS),
        column(5, REFERENCES),
        column(6, ENGINES_2),
    )
    return tuple(CasePlan(*row) for row in zip(*columns, strict=True))


def dealt(
    shares: Mapping[Key, float], count: int, rng: np.random.Generator
) -> list[Key]:
    """Deal keys over `count` cases in proportion to their shares, in random order.

    Each key comes floor(share count) times at least; the cases left over go to the keys
    with the largest remainders (method of largest remainders, Hamilton's).
    """
    wanted = np.array(list(shares.values())) / sum(shares.values()) * count
    times = np.floor(wanted + 1e-9).astype(int)
    largest = np.argsort(-(wanted - times), kind="stable")
    times[largest[: count - int(times.sum())]] += 1
    every = [
        key for key, n in zip(shares, times.tolist(), strict=True) for _ in range(n)
    ]
    return [every[i] for i in rng.permutation(count)]
