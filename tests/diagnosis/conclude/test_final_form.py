"""Further values need evidence, of blocks of time where much is left."""

from types import SimpleNamespace

import numpy as np

from diagnosis.conclude import final_form
from diagnosis.conclude.final_form import simplified
from diagnosis.effects.parts import PlacedEffect

PEAK = PlacedEffect("stribeck_friction", "elbow", (1.0, 0.5, 0.1))
PLAIN = PlacedEffect("coulomb_friction", "elbow", (1.0,))


def form(monkeypatch, left, gain, blocks):
    """The friction that is stated, by what is left with a peak of friction [nats].

    `gain` is how much more is left without it; the noise is 500 nats.
    """
    whole = SimpleNamespace(model=(PEAK,), energy=left, residual=np.ones(1000))
    part = SimpleNamespace(model=(PLAIN,), energy=left + gain)
    monkeypatch.setattr(final_form, "fit_all", lambda both, models: (whole, part))
    monkeypatch.setattr(final_form, "independent_samples", lambda both, left: blocks)
    both = SimpleNamespace(noise_energy=500.0)
    (placed,) = simplified(both, (PEAK,))
    return placed.name


def test_at_the_noise_each_row_is_evidence(monkeypatch):
    assert form(monkeypatch, 600.0, gain=30.0, blocks=20) == PEAK.name
    assert form(monkeypatch, 600.0, gain=1.0, blocks=20) == PLAIN.name


def test_where_much_is_left_blocks_of_time_are(monkeypatch):
    """A tenth more is left: 1 nat of 20 blocks, 48 nats of 1000."""
    assert form(monkeypatch, 5e4, gain=5e3, blocks=20) == PLAIN.name
    assert form(monkeypatch, 5e4, gain=5e3, blocks=1000) == PEAK.name
