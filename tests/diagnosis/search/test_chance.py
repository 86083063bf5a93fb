"""Gains by chance: what noise gives, and what patterns in time give."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.signal import lfilter
from scipy.stats import chi2

from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.signatures import Signature
from diagnosis.search.chance import FEWEST_BLOCKS, independent_blocks
from diagnosis.search.screening import Screen

ROWS = 4000
PREDICTOR = SimpleNamespace(
    channels=SimpleNamespace(names=("position.elbow",)),
    traces=[SimpleNamespace(ticks=ROWS // 2)] * 2,
    trace=np.repeat([0, 1], ROWS // 2),
    scored=np.ones(ROWS, bool),
)


def noise(seed, memory=0.0):
    """(ROWS,) of variance 1, each value `memory` times the one before and more."""
    white = np.random.default_rng(seed).standard_normal(ROWS)
    return lfilter([np.sqrt(1 - memory**2)], [1.0, -memory], white)


def screen(count):
    """A screen of effects whose changes have nothing in common."""
    random = np.random.default_rng(99)
    return Screen(
        PREDICTOR,
        [
            Signature(
                PlacedEffect("servo_gain", f"joint {k}", (0.8,)),
                random.standard_normal(ROWS),
                np.arange(ROWS),
                True,
            )
            for k in range(count)
        ],
    )


def test_blocks_are_as_long_as_the_memory_of_the_residual():
    short = independent_blocks(PREDICTOR, noise(1)).max() + 1
    long = independent_blocks(PREDICTOR, noise(1, memory=0.98)).max() + 1
    assert short > 500
    assert FEWEST_BLOCKS <= long < 0.25 * short


def test_no_block_holds_rows_of_two_recordings():
    block = independent_blocks(PREDICTOR, noise(2, memory=0.9))
    assert block[ROWS // 2 - 1] != block[ROWS // 2]


@pytest.mark.parametrize("count", [1, 40])
def test_of_white_noise_it_is_what_theory_says(count):
    """The largest of so many squares of normal numbers, in 99 of 100 cases."""
    wanted = 0.5 * chi2.isf(1 - 0.99 ** (1 / count), 1)
    found = np.mean([screen(count).gain_by_chance(noise(k)) for k in range(8)])
    assert found == pytest.approx(wanted, rel=0.2)


def test_slow_patterns_reach_more():
    random = np.random.default_rng(5)
    slow = np.cumsum(random.standard_normal(ROWS))
    one = Signature(
        PlacedEffect("servo_gain", "elbow", (0.8,)), slow, np.arange(ROWS), True
    )
    screen = Screen(PREDICTOR, [one])
    fast, lasting = (screen.gain_by_chance(noise(7, memory)) for memory in (0.0, 0.98))
    assert lasting > 5 * fast
