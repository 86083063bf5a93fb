"""Each baseline names what is plain to see, and nothing where nothing is missing."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from three_sines import KD, KP, LIMIT, XML, swing

from diagnosis.baselines import BASELINES, bic, sparse, sysid
from diagnosis.baselines.found import found_effect
from diagnosis.baselines.sparse import sequential_threshold
from diagnosis.effects.parts import PlacedEffect
from diagnosis.plant.load import load_plant
from diagnosis.residuals.predictor import Predictor
from diagnosis.search.fitting import fit_all
from diagnosis.verdict import Estimate, Verdict
from groundwalk.errors import GroundwalkError
from worlds.recordings.metadata import ServoGains

NEEDS_SYSID = pytest.mark.skipif(
    not hasattr(__import__("mujoco.sysid").sysid, "optimize"),
    reason="mujoco[sysid] is not installed",
)


def first(verdict):
    return verdict.effects[0].name, verdict.effects[0].place


@pytest.mark.slow
def test_bic_names_dry_friction_with_its_value_only_where_it_is(plant, dry, clean):
    verdict = bic.answer(plant, dry)
    assert (verdict.kind, first(verdict)) == (
        "effects",
        ("coulomb_friction", "swing"),
    )
    torque = verdict.effects[0].parameters["torque"]
    assert torque.value == pytest.approx(0.15, rel=0.1)
    assert torque.low < torque.value < torque.high
    assert verdict.effects[0].probability > 0.9
    assert verdict.recordings.fit == ("swing_0", "swing_1")
    # it is known to name what is too small to matter, but not this
    others = bic.answer(plant, clean).effects
    assert "coulomb_friction" not in {each.name for each in others}


def test_bic_charges_each_parameter_half_the_logarithm_of_the_samples(plant, clean):
    predictor = Predictor(plant, clean)
    one, three = (
        fit_all(predictor, [(PlacedEffect(*placed),)], steps=1)[0]
        for placed in (
            ("viscous_friction", "swing", (0.01,)),
            ("stribeck_friction", "swing", (0.01, 0.01, 0.1)),
        )
    )
    for fit, parameters in ((one, 1), (three, 3)):
        energy = float(fit.residual @ fit.residual)
        charged = bic.criterion(fit, 1000) - energy
        assert charged == pytest.approx(parameters * np.log(1000))


def test_sparse_names_dry_friction_only_where_it_is(plant, dry, clean):
    verdict = sparse.answer(plant, dry)
    assert (verdict.kind, first(verdict)) == (
        "effects",
        ("coulomb_friction", "swing"),
    )
    torque = verdict.effects[0].parameters["torque"].value
    assert torque == pytest.approx(0.15, rel=0.4)  # smoothing takes some of it
    assert sum(each.probability for each in verdict.effects) <= 1 + 1e-9
    assert sparse.answer(plant, clean).kind == "none"


def test_a_sliding_joint_has_forces_and_metres(tmp_path):
    path = tmp_path / "sled.xml"
    path.write_text(XML.replace('axis="0 1 0"', 'axis="1 0 0" type="slide"'))
    sled = load_plant(path, "fixed", servo=ServoGains(KP, KD, LIMIT))
    rubs = PlacedEffect("coulomb_friction", "swing", (0.15,))
    found = found_effect(sled, rubs, [(0.1, 0.2)], 0.9)
    assert found.parameters["torque"] == Estimate(0.15, 0.1, 0.2, "N")


def test_thresholding_keeps_what_made_the_target_and_drops_the_rest():
    rng = np.random.default_rng(3)
    columns = rng.normal(size=(400, 6)) * [1, 10, 1, 1, 0, 1]
    target = 3 * columns[:, 1] - 20 * columns[:, 3] + rng.normal(0, 0.1, 400)
    kept, size, error = sequential_threshold(columns, target)
    np.testing.assert_array_equal(kept, [1, 3])
    np.testing.assert_allclose(size, [3, -20], rtol=0.1)
    assert (error > 0).all()
    kept, size, _ = sequential_threshold(columns, rng.normal(size=400) * 1e-3, 0.5)
    assert len(kept) == len(size) == 0


@NEEDS_SYSID
@pytest.mark.slow
def test_sysid_names_a_stiffer_servo_and_nothing_where_nothing_is_missing(plant, clean):
    stiff = [swing(plant, seed, gain=1.3) for seed in (0, 1)]
    verdict = sysid.answer(plant, stiff)
    assert (verdict.kind, first(verdict)) == (
        "effects",
        ("servo_gain", "swing"),
    )
    factor = verdict.effects[0].parameters["factor"]
    assert factor.value == pytest.approx(1.3, rel=0.05)
    assert factor.low < factor.value < factor.high
    assert sysid.answer(plant, clean).kind == "none"


def test_sysid_says_so_where_its_package_is_not_whole(plant, clean, monkeypatch):
    monkeypatch.setattr(sysid, "import_module", lambda name: SimpleNamespace())
    with pytest.raises(GroundwalkError, match=r"pip install 'mujoco\[sysid\]'"):
        sysid.answer(plant, clean)


def test_without_a_position_command_or_with_a_free_base_sparse_abstains(plant, dry):
    torque_driven = [replace(dry[0], command_rad=None)]
    floating = replace(plant, base="floating")
    for verdict in (
        sparse.answer(plant, torque_driven),
        sparse.answer(floating, dry),
    ):
        assert verdict.kind == "not_identifiable"
        assert "fixed base" in verdict.limits[0]


def test_answers_survive_being_written(plant, dry):
    verdict = BASELINES["sparse"](plant, dry, None)
    assert Verdict.from_json(verdict.to_json()) == verdict
    assert verdict.seconds > 0
