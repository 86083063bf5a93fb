"""Further values need evidence that lasts longer than what changes at random."""

from types import SimpleNamespace

import numpy as np
import pytest

from diagnosis.conclude import final_form
from diagnosis.conclude.final_form import simplified
from diagnosis.effects.parts import PlacedEffect

PEAK = PlacedEffect("stribeck_friction", "elbow", (1.0, 0.5, 0.1))
PLAIN = PlacedEffect("coulomb_friction", "elbow", (1.0,))
BLOCKS, ROWS = 64, 100


def form(monkeypatch, whole, part):
    """The friction that is stated, by residuals with a peak of friction and without.

    Both are (6400,), 100 in each block of time.
    """
    fits = [
        SimpleNamespace(model=(model,), energy=0.5 * left @ left, residual=left)
        for model, left in ((PEAK, whole), (PLAIN, part))
    ]
    block = np.repeat(np.arange(BLOCKS), ROWS)
    monkeypatch.setattr(final_form, "fit_all", lambda both, models: fits)
    monkeypatch.setattr(final_form, "independent_blocks", lambda both, left: block)
    (placed,) = simplified(SimpleNamespace(), (PEAK,))
    return placed.name


@pytest.mark.parametrize(("nats", "name"), [(30.0, PEAK.name), (1.0, PLAIN.name)])
def test_beside_noise_each_row_is_evidence(monkeypatch, nats, name):
    """What is missing has an energy of 30 nats, or of 1, and is anywhere."""
    noise, missing = np.random.default_rng(1).normal(size=(2, BLOCKS * ROWS))
    missing -= (missing @ noise) / (noise @ noise) * noise  # a fit leaves it so
    missing *= np.sqrt(2 * nats / (missing @ missing))
    assert form(monkeypatch, noise, noise + missing) == name


def gaining(nats):
    """Residuals with a peak of friction and without, which leaves (64,) `nats` more."""
    whole = np.full(BLOCKS * ROWS, 2.0)
    return whole, np.sqrt(whole**2 + 2 * np.repeat(nats / ROWS, ROWS))


@pytest.mark.parametrize(("gain", "name"), [(16.0, PEAK.name), (2.0, PLAIN.name)])
def test_gains_that_change_at_random_are_less(monkeypatch, gain, name):
    """Blocks gain 16 or 2 nats each, with a standard deviation of 20.

    The means are 6 standard errors from 0, and less than one; by rows 128 nats in all
    would be proof.
    """
    scatter = np.random.default_rng(2).normal(size=BLOCKS)
    scatter = 20.0 * (scatter - scatter.mean()) / scatter.std()
    assert form(monkeypatch, *gaining(gain + scatter)) == name


def test_it_may_show_in_a_few_moments_if_it_loses_in_none(monkeypatch):
    """Friction with a peak at standstill shows when a joint starts to move."""
    nats = np.where(np.arange(BLOCKS) % 16 == 0, 10.0, 0.3)
    assert form(monkeypatch, *gaining(nats)) == PEAK.name
    nats = np.where(np.arange(BLOCKS) % 16 == 0, 10.0, -0.3)
    assert form(monkeypatch, *gaining(nats)) == PLAIN.name
