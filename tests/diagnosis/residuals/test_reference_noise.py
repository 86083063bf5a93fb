"""Errors that were there when all was well count as noise, others as evidence."""

import numpy as np
import pytest
from scipy.stats import chi2
from swinger_rig import moved, swinger

from diagnosis.residuals import reference_noise
from diagnosis.residuals.reference_noise import (
    WAVES,
    Block,
    ReferenceNoise,
    blocks_of,
)
from diagnosis.traces.windows import FLOATING_WINDOW_S, runs_of
from groundwalk.errors import BadRecordingError

CHANNELS, ROWS = 3, 30
LINE = np.linspace(-1, 1, ROWS) / np.linalg.norm(np.linspace(-1, 1, ROWS))
LEVEL = np.full(ROWS, ROWS**-0.5)


def blocks(count, rows=ROWS):
    times = (np.arange(rows) + 0.5) / rows
    waves = np.linalg.qr(np.polynomial.legendre.legvander(2 * times - 1, WAVES - 1))[0]
    return [Block(slice(k * rows, (k + 1) * rows), waves) for k in range(count)]


def errors(count, seed, quick=(1.0, 1.0, 1.0), size=30.0):
    """White noise, and a drift of two channels together, of another size each time."""
    random = np.random.default_rng(seed)
    found = np.array(quick) * random.standard_normal((count, ROWS, CHANNELS))
    drift = size * random.standard_normal(count)
    found += drift[:, None, None] * LINE[:, None] * np.array([0.6, -0.8, 0.0])
    return found.reshape(-1, CHANNELS)


def learned(count=200, **options):
    residual = errors(count, 0, **options)
    return ReferenceNoise.of((), residual, np.ones(residual.shape, bool), blocks(count))


def whitened(standing, residual, rows=ROWS):
    return standing.without(residual[None], blocks(len(residual) // rows, rows))[0]


def energy(standing, shape):
    """What is left of an error of size one in one block."""
    return float((whitened(standing, np.asarray(shape)) ** 2).sum())


def test_what_was_there_before_is_as_large_as_noise():
    standing = learned()
    assert (errors(100, 1) ** 2).mean() > 5
    assert (whitened(standing, errors(100, 1)) ** 2).mean() == pytest.approx(1, abs=0.1)


def test_only_errors_of_the_known_shape_are_discounted():
    standing = learned()
    known = np.outer(LINE, [0.6, -0.8, 0.0])
    assert energy(standing, known) < 3 / 30**2
    for other in (
        np.outer(LINE, [0.8, 0.6, 0.0]),
        np.outer(LINE, [0.0, 0.0, 1.0]),
        np.outer(LEVEL, [0.6, -0.8, 0.0]),
        np.outer((-1.0) ** np.arange(ROWS) / ROWS**0.5, [0.6, -0.8, 0.0]),
    ):
        assert 0.5 < energy(standing, other) < 1.1


def test_a_channel_that_is_noisier_than_thought_is_trusted_less_none_more():
    standing = learned(quick=(3.0, 1.0, 0.2))
    np.testing.assert_allclose(standing.scale, [3, 1, 1], rtol=0.05)
    third = np.outer(LEVEL, [0.0, 0.0, 1.0])
    assert energy(standing, third) == pytest.approx(1, abs=0.05)


def test_fewer_rows_see_less_of_a_smooth_error():
    standing, half = learned(), ROWS // 2
    shape = np.linspace(-1, 1, half) / np.linalg.norm(np.linspace(-1, 1, half))
    known = np.outer(shape, [0.6, -0.8, 0.0])
    left = float((whitened(standing, known, half) ** 2).sum())
    assert left == pytest.approx(1 / (1 + 30**2 / 2), rel=0.25)


def test_few_blocks_do_not_make_it_blind():
    """Twelve quantities from six blocks: their sample covariance has no inverse."""
    standing = learned(count=6, size=0.0)
    random = np.random.default_rng(3)
    fresh = random.standard_normal((100 * ROWS, CHANNELS))
    assert (whitened(standing, fresh) ** 2).mean() > 0.8


def test_blocks_are_windows_with_orthonormal_waves():
    trace = moved(0, duration_s=0.8)
    runs = runs_of(swinger(), trace)
    scored = np.ones(trace.ticks, bool)
    scored[5] = False
    edge, *found = blocks_of(runs, scored)
    assert edge.waves.shape == (5, 0)
    assert [block.rows.stop - block.rows.start for block in found] == [30, 30, 15]
    for block in found:
        np.testing.assert_allclose(
            block.waves.T @ block.waves, np.eye(WAVES), atol=1e-9
        )
    assert not found[0].waves[0].any()
    assert found[1].waves[0].any()


def test_a_whole_run_is_cut_into_blocks_and_scraps_have_no_waves():
    trace = moved(0, duration_s=2 * FLOATING_WINDOW_S + 0.05)
    (whole,) = [runs_of(swinger(), trace)[0]]
    long = [type(whole)(trace, whole.position_rad, whole.velocity_rad_s)]
    found = blocks_of(long, np.ones(trace.ticks, bool))
    assert [block.waves.shape for block in found] == [(30, WAVES), (30, WAVES), (5, 0)]


def test_nothing_can_be_learned_from_a_moment():
    scored = np.ones((5, CHANNELS), bool)
    scrap = [Block(slice(0, 5), np.zeros((5, 0)))]
    with pytest.raises(BadRecordingError, match="too short"):
        ReferenceNoise.of((), np.zeros((5, CHANNELS)), scored, scrap)


def knowing(pulls, change=20.0, rows=ROWS):
    """What one recording for each of `pulls` leaves unknown of one value.

    The value changes all rows of one channel, `change` in all [noise]; in each
    recording the pull is the share of that which is left.
    """
    count = len(pulls)
    one = np.zeros((count * rows, CHANNELS))
    one[:, 2] = change / np.sqrt(rows * count)
    left = np.zeros_like(one)
    for k, pull in enumerate(pulls):
        left[k * rows : (k + 1) * rows, 2] = pull * one[k * rows : (k + 1) * rows, 2]
    known = ReferenceNoise.known((), CHANNELS)
    number = np.repeat(np.arange(count), rows)
    return known.knowing(one[None], left, blocks(count), number).spread[0, 0]


def test_what_recordings_that_agree_leave_unknown():
    """One standard deviation changes the residual by 20 of its noise."""
    assert knowing([0.0, 0.0, 0.0]) == pytest.approx(1 / (1 + 20**2))


def test_what_recordings_differ_by_is_unknown_as_well():
    """Each recording of n tells the value to 1 / n of the information."""
    pulls = np.array([3.0, -1.0, -2.0])
    agreed, differs = 1 / (1 + 20**2), np.var(pulls, ddof=1)
    assert knowing(pulls) == pytest.approx(agreed + 2 * differs / 3, rel=0.01)


@pytest.mark.parametrize(("times", "differs"), [(0.98, False), (1.02, True)])
def test_what_noise_alone_makes_them_differ_by_is_no_difference(times, differs):
    """Two degrees of freedom, since what they have in common is fitted."""
    pulls = np.array([3.0, -1.0, -2.0])
    told = 20**2 / (1 + 20**2)
    square = chi2.isf(reference_noise.LEVEL, 2 * told) / 3 * (1 + 20**2)
    by_one = 20**2 / 3  # products of a recording's changes
    pulls *= times * np.sqrt(square / (by_one**2 * np.sum(pulls**2)))
    assert (knowing(pulls) > 1.1 / (1 + 20**2)) == differs


@pytest.mark.parametrize("factor", [0.5, 2.0])
def test_half_or_twice_the_level_tells_the_same(monkeypatch, factor):
    monkeypatch.setattr(reference_noise, "LEVEL", factor * reference_noise.LEVEL)
    assert knowing([0.02, 0.0, -0.02]) == pytest.approx(1 / (1 + 20**2))
    assert knowing([3.0, -1.0, -2.0]) > 1


def test_of_one_recording_it_is_not_known_what_others_differ_by():
    assert knowing([4.0]) == pytest.approx(1 / (1 + 20**2))
