"""Rungs of the friction ladder are told apart on a bench with known loads."""

import numpy as np
import pytest
from servo_bench import (
    EMF,
    JOINT,
    KP,
    OHM,
    STALL_NM,
    SUPPLY_V,
    TORQUE_PER_A,
    load,
    nominal,
    recorded,
)

from diagnosis.effects.library import effect
from diagnosis.effects.parts import PlacedEffect
from diagnosis.pipeline import diagnose
from diagnosis.residuals.predictor import Predictor
from diagnosis.search.fitting import fit_all
from worlds.hidden.servos import servo_torque_nm

LOAD = load(2.0, 0.2)
PEAK = (0.1, 0.2, 0.6, 1.4)
TRUTHS = {
    "gear_friction": (0.1, 0.12),
    "gear_stribeck_friction": (*PEAK, 0.08, 0.1),
    "directional_gear_friction": (*PEAK, 0.02, 0.15, 0.05, 0.15),
    "quadratic_gear_friction": (*PEAK, 0.05, 0.1, 0.05, 0.1, 0.1),
}
SIMPLER = {"gear_friction": "coulomb_friction"}
"""The form to compare with, where it is not the first one."""


def test_a_voltage_at_a_motor_is_a_servo_with_back_emf():
    """kt / R clip(duty e) V - kt^2 / R w, at small and large errors and speeds."""
    error, speed = np.array([-0.5, -0.1, 0.05, 0.9]), np.array([0.3, -1.0, 2.0, 4.0])
    volt = np.clip(KP / STALL_NM * error, -1, 1) * SUPPLY_V
    wanted = TORQUE_PER_A / OHM * (volt - TORQUE_PER_A * speed)
    gains = tuple(np.array([one]) for one in (KP, 0.0, EMF, STALL_NM))
    np.testing.assert_allclose(servo_torque_nm(gains, error, speed), wanted)


def as_text(plant, truth):
    """An effect as the hidden world reads it."""
    names = [one.name for one in effect(truth.name).parameters(plant, truth.place)]
    pairs = zip(names, truth.values, strict=True)
    return f"{truth.key}:" + ",".join(f"{name}={value}" for name, value in pairs)


def bench(tmp_path, truth):
    """A predictor of one recording of the bench with the effect `truth`."""
    plant = nominal(tmp_path, LOAD)
    trace = recorded([as_text(plant, truth)], plant, LOAD, seed=1, duration_s=6.0)
    predictor = Predictor(plant, [trace])
    predictor.calibrate((truth,))
    return predictor


def simpler_of(placed):
    """The nearest simpler form of an effect."""
    forms = effect(placed.name).simpler(placed)
    name = SIMPLER.get(placed.name, forms[0].name)
    return next(one for one in forms if one.name == name)


def gain(predictor, truth, rung):
    """Nats that a rung gains over its simpler form."""
    start = truth if truth.name != rung else simpler_of(truth)
    (below,) = fit_all(predictor, [(start,)])
    grown = effect(rung).grown_from(below.model[0])
    above = min(
        fit_all(predictor, [(one,) for one in grown]), key=lambda fit: fit.energy
    )
    return below.energy - above.energy


@pytest.mark.slow
@pytest.mark.parametrize("size", [0.5, 1.0, 2.0])
@pytest.mark.parametrize("name", TRUTHS)
def test_a_rung_explains_what_the_one_below_does_not(name, size, tmp_path):
    """Shares and the square term are half as large, as stated, and twice as large."""
    keep = 1 if name == "gear_friction" else len(PEAK)
    values = TRUTHS[name]
    values = (*values[:keep], *(size * value for value in values[keep:]))
    truth = PlacedEffect(name, JOINT, values)
    more = gain(bench(tmp_path, truth), truth, name)
    assert more > 30.0


@pytest.mark.slow
@pytest.mark.parametrize("name", TRUTHS)
def test_a_rung_gains_no_more_than_chance_where_the_one_below_is_true(name, tmp_path):
    truth = simpler_of(PlacedEffect(name, JOINT, TRUTHS[name]))
    more = gain(bench(tmp_path, truth), truth, name)
    assert more < 10.0


LOADS = [load(mass, lever) for lever in (0.1, 0.15) for mass in (0.5, 1.0, 1.5, 3.0)]
RUNGS = {
    "shaped_stribeck_friction": (0.3, 0.2, 0.6, 1.4),
    "quadratic_gear_friction": (0.1, 0.2, 0.6, 1.4, 0.05, 0.1, 0.05, 0.1, 0.02),
}
VISCOUS = PlacedEffect("viscous_friction", JOINT, (0.05,))


@pytest.mark.slow
@pytest.mark.parametrize("name", RUNGS)
def test_four_masses_on_two_levers_tell_the_rung(name, tmp_path):
    plant = nominal(tmp_path, *LOADS)
    truth = PlacedEffect(name, JOINT, RUNGS[name])
    hidden = [as_text(plant, truth), as_text(plant, VISCOUS)]
    traces = [
        recorded(hidden, plant, carried, seed=1 + number, duration_s=6.0)
        for number, carried in enumerate(LOADS)
    ]
    found = diagnose(plant, traces, np.random.SeedSequence(1))
    assert [(one.name, one.place) for one in found.verdict.effects] == [(name, JOINT)]
    left, least = found.test.residuals([found.model, (truth, VISCOUS)])
    assert left @ left < 1.2**2 * (least @ least)
    values = {
        key: one.value for key, one in found.verdict.effects[0].parameters.items()
    }
    right = dict(zip(values, truth.values, strict=True))
    for key in ("extra_torque", "link_share", "motor_share"):
        assert key not in right or values[key] == pytest.approx(right[key], rel=0.2)
