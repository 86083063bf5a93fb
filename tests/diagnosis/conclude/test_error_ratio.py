"""Ratios of errors whose truth is a number: errors are drawn with known sizes."""

from types import SimpleNamespace

import numpy as np
import pytest

from diagnosis.conclude.error_ratio import Squares, squares_of

SEED = np.random.SeedSequence(3)


def squares(before, after, count=10.0):
    """Sums over blocks of one channel, from mean squares (u,)."""
    counts = np.full((len(before), 1), count)
    sums = (count * np.asarray(one, float)[:, None] for one in (before, after))
    return Squares("blocks of time", *sums, counts)


def rig(lengths=(400,), channels=2, noise=1.0, floor=1.0):
    """As much of a predictor of recordings as is asked for here; all rows count."""
    names = tuple(f"position.{k}" for k in range(channels))
    rows = sum(lengths)
    return SimpleNamespace(
        traces=[None] * len(lengths),
        channels=SimpleNamespace(
            names=names, noise=np.full(channels, noise), floor=np.full(channels, floor)
        ),
        channel=np.tile(np.arange(channels), rows),
        trace=np.repeat(np.arange(len(lengths)), np.array(lengths) * channels),
        scored=np.ones(rows * channels, bool),
    )


def test_a_ratio_is_that_of_root_mean_squares():
    before = Squares(
        "recordings",
        before=np.array([[90.0, 640.0], [90.0, 640.0]]),
        after=np.array([[10.0, 40.0], [10.0, 40.0]]),
        count=np.full((2, 2), 10.0),
    )
    together, (first, second) = before.ratios(SEED)
    # mean squares 9 and 64 before, 1 and 4 after
    assert together.value == pytest.approx(np.sqrt((9 + 64) / (1 + 4)))
    assert first.value == pytest.approx(3.0)
    assert second.value == pytest.approx(4.0)
    for one in (together, first, second):  # both units say the same
        assert one.low == pytest.approx(one.value) == pytest.approx(one.high)


def test_where_blocks_differ_the_interval_is_wide():
    even = squares(np.full(20, 4.0), np.linspace(0.9, 1.1, 20)).ratios(SEED)[0]
    uneven = squares(np.full(20, 4.0), np.linspace(0.1, 1.9, 20)).ratios(SEED)[0]
    assert even.value == pytest.approx(2.0) == pytest.approx(uneven.value)
    assert uneven.low < even.low < 2.0 < even.high < uneven.high
    assert uneven.high - uneven.low > 5 * (even.high - even.low)


def test_intervals_hold_the_truth_as_often_as_they_say():
    """Errors of size 2 and 1, in twelve blocks: the truth is 2, and it is not 1.3."""
    holds = wrong = 0
    for seed in range(150):
        draw = np.random.default_rng(seed).chisquare(6, (2, 12)) / 6
        ratio = squares(4 * draw[0], draw[1]).ratios(np.random.SeedSequence(seed))[0]
        holds += ratio.low < 2.0 < ratio.high
        wrong += ratio.low < 1.3 < ratio.high
    assert 0.89 * 150 < holds < 150  # 95 % of 150, less 3.4 standard errors
    assert wrong < 0.2 * 150


def test_errors_are_counted_in_noise_floors():
    some = rig(noise=1.0, floor=0.5)
    found = squares_of(some, np.full(800, 3.0), np.full(800, 1.0))
    before, after = found.rms()
    assert before == pytest.approx([6.0, 6.0])
    assert after == pytest.approx([2.0, 2.0])


def test_what_does_not_count_is_left_out():
    some = rig()
    some.scored[:400] = False
    left = np.where(some.scored, 2.0, 0.0)
    assert squares_of(some, left, left).rms()[0] == pytest.approx([2.0, 2.0])


def test_errors_that_last_are_in_few_blocks():
    """White noise changes from row to row; a slow wave, and noise that swells, last."""
    rng, rows = np.random.default_rng(0), 6000
    some = rig((rows,), channels=1)
    white, other = rng.standard_normal((2, rows))
    swell = np.exp(2 * np.sin(2 * np.pi * np.arange(rows) / 1000))
    wave = np.sin(2 * np.pi * np.arange(rows) / 300)
    many, swelling, waving = (
        squares_of(some, one, other) for one in (white, swell * white, wave)
    )
    assert many.unit == "blocks of time"
    assert len(many.count) > 200
    assert 12 <= len(swelling.count) < 100
    assert 12 <= len(waving.count) < 100


def test_blocks_are_within_recordings_and_many_recordings_are_the_units():
    def left(lengths):
        rng = np.random.default_rng(1)
        return rng.standard_normal((2, 2 * sum(lengths)))

    few, many = (300, 200), (100, 90, 80, 70, 60)
    assert squares_of(rig(few), *left(few)).unit == "blocks of time"
    found = squares_of(rig(many), *left(many))
    assert found.unit == "recordings"
    assert found.count[:, 0].tolist() == list(many)
