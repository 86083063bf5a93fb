"""What a model does not need is taken out of it, down to nothing."""

import pytest
from torque_arm import arm, moved, rubbing

from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.torques.torque_evidence import with_motions
from diagnosis.residuals.torques.torque_predictor import predictor_of
from diagnosis.search.judging import Judge
from diagnosis.search.many import pruning
from diagnosis.search.many.fits import Fits
from diagnosis.search.many.pruning import pruned

IDLE = PlacedEffect("viscous_friction", "elbow", (0.01,))
ENDLESS = PlacedEffect("speed_limit", "elbow", (20.0,))
DRY = PlacedEffect("coulomb_friction", "yaw", (0.5,))


def fits_of(*dry_nm):
    rubs = rubbing(dry_nm, (0.0, 0.0, 0.0))
    parts = []
    for seed in (0, 1):
        trace = moved(rubs, seed=seed, duration_s=5.0)
        found = predictor_of(arm(), with_motions(arm(), [trace]))
        found.calibrate()
        parts.append(found)
    return Fits(Judge(*parts))


@pytest.fixture(scope="module")
def rubs():
    return fits_of(1.0, 0.0, 0.0)


@pytest.mark.parametrize("idle", [IDLE, ENDLESS])
def test_what_explains_nothing_is_taken_out(rubs, idle):
    """That of a speed limit no finite value stands for no effect does not keep it."""
    best = pruned(rubs, rubs.fitted((DRY, idle)))
    (kept,) = best.model
    assert kept.key == DRY.key
    assert kept.values[0] == pytest.approx(1.0, rel=0.05)


def test_what_is_needed_stays(rubs):
    best = pruned(rubs, rubs.fitted((DRY,)))
    assert [placed.key for placed in best.model] == [DRY.key]


def test_nothing_may_be_left():
    exact = fits_of(0.0, 0.0, 0.0)
    assert pruned(exact, exact.fitted((IDLE,))).model == ()


def test_joints_share_values_that_are_alike_and_no_others():
    """Frictions that differ by 2 % are alike beside noise, those by 40 % are not."""
    frictions = fits_of(1.0, 1.02, 0.6)
    joints = "yaw", "shoulder", "elbow"
    each = [PlacedEffect("coulomb_friction", one, (0.8,)) for one in joints]
    best = pruned(frictions, frictions.fitted(tuple(each)))
    found = {placed.place: placed for placed in best.model}
    assert found["yaw"].tied == found["shoulder"].tied == "shoulder"
    assert found["yaw"].values == found["shoulder"].values
    assert found["yaw"].values[0] == pytest.approx(1.01, rel=0.02)
    assert not found["elbow"].tied
    assert found["elbow"].values[0] == pytest.approx(0.6, rel=0.03)


@pytest.mark.parametrize("nats", [10.0, 40.0])
def test_what_is_clearly_needed_may_differ_by_a_factor_of_two(nats, monkeypatch):
    """Less is tried without, or more, but the same is kept."""
    frictions = fits_of(1.0, 1.02, 0.6)
    each = [PlacedEffect("coulomb_friction", one, (0.8,))
            for one in ("yaw", "shoulder", "elbow")]  # fmt: skip
    begun = frictions.fitted((*each, IDLE))
    usual = pruned(frictions, begun)
    monkeypatch.setattr(pruning, "CLEARLY", nats)
    other = pruned(frictions, begun)
    assert {(one.key, one.tied) for one in other.model} == {
        (one.key, one.tied) for one in usual.model
    }
