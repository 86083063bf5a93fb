"""Values of effects from recordings whose truth is known."""

import numpy as np
import pytest
from made_up_traces import arm, recorded

from diagnosis.effects.library import all_effects, effect
from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.predictor import Channels, Predictor
from diagnosis.search.fitting import Coordinates, _Course, fit_all
from diagnosis.search.nudges import nudges_of

NOISE_RAD = 4e-4
CHANNELS = Channels(("position.shoulder", "position.elbow"), np.full(2, NOISE_RAD))
START_S = 0.004
ROUNDS = 3


def predictor_of(*effects, noise_rad, model=(), **more):
    plant = arm()
    trace = recorded(plant, *effects, noise_rad=noise_rad, duration_s=2.0, **more)
    predictor = Predictor(plant, [trace], CHANNELS, step_s=START_S)
    predictor.calibrate(model, tolerances=False)
    return predictor


@pytest.mark.parametrize(
    ("name", "place", "start", "truth", "tolerance"),
    [
        ("viscous_friction", "elbow", (0.1,), (0.4,), 0.03),
        ("coulomb_friction", "shoulder", (0.05,), (0.3,), 0.1),
        ("servo_gain", "elbow", (1.0,), (0.7,), 0.02),
        ("armature", "elbow", (0.003,), (0.02,), 0.05),
        ("payload_mass", "lower", (0.01,), (0.15,), 0.04),
        ("command_latency", "commands", (0.005,), (0.0233,), 0.03),
        ("encoder_offset", "elbow", (0.0,), (-0.05,), 0.03),
        ("backlash", "elbow", (0.04,), (0.05,), 0.12),
    ],
)
def test_values_without_noise(name, place, start, truth, tolerance):
    """Starts near nothing, calibrated there; then once more where that leads to."""
    predictor = predictor_of((name, place, *truth), noise_rad=0.0)
    model = (PlacedEffect(name, place, start),)
    for _ in range(ROUNDS):
        (fit,) = fit_all(predictor, [model])
        model = fit.model
        predictor.calibrate(model, tolerances=False)
    (found,) = fit.model
    assert (found.name, found.place) == (name, place)
    assert found.values == pytest.approx(truth, rel=tolerance)
    nothing = predictor.residuals([()])[0]
    assert fit.energy < 0.02 * 0.5 * nothing @ nothing


def test_values_with_noise_are_as_sure_as_their_jacobian_says():
    """Errors of least squares have the covariance (J^T J)^-1."""
    truth = PlacedEffect("servo_gain", "elbow", (0.7,))
    wrong = []
    for seed in range(6):
        predictor = predictor_of(
            ("servo_gain", "elbow", 0.7),
            noise_rad=NOISE_RAD,
            model=(truth,),
            seed=seed,
        )
        (fit,) = fit_all(predictor, [(PlacedEffect("servo_gain", "elbow", (0.9,)),)])
        spread = 1 / np.sqrt((fit.jacobian.T @ fit.jacobian)[0, 0])
        wrong.append((np.log(fit.model[0].values[0]) - np.log(0.7)) / spread)
        assert fit.energy == pytest.approx(predictor.scored.sum() / 2, rel=0.4)
    assert np.abs(wrong).max() < 4
    assert np.sqrt(np.mean(np.square(wrong))) > 0.2


def test_two_effects_at_once():
    effects = ("servo_gain", "elbow", 0.8), ("viscous_friction", "shoulder", 0.5)
    predictor = predictor_of(*effects, noise_rad=NOISE_RAD)
    start = (
        PlacedEffect("servo_gain", "elbow", (1.0,)),
        PlacedEffect("viscous_friction", "shoulder", (0.05,)),
    )
    (fit,) = fit_all(predictor, [start])
    assert fit.model[0].values[0] == pytest.approx(0.8, rel=0.02)
    assert fit.model[1].values[0] == pytest.approx(0.5, rel=0.1)
    assert fit.jacobian.shape == (len(fit.residual), 2)


def test_fits_side_by_side_are_as_alone():
    predictor = predictor_of(("servo_gain", "elbow", 0.7), noise_rad=NOISE_RAD)
    starts = [
        (PlacedEffect("servo_gain", "elbow", (1.0,)),),
        (PlacedEffect("viscous_friction", "elbow", (0.05,)),),
        (PlacedEffect("servo_gain", "shoulder", (1.0,)),),
        (),
    ]
    starts = starts[:3]
    together = fit_all(predictor, starts)
    for start, fit in zip(starts, together, strict=True):
        (alone,) = fit_all(predictor, [start])
        assert fit.model[0].values == pytest.approx(alone.model[0].values, rel=1e-4)
    assert min(together, key=lambda fit: fit.energy) is together[0]
    assert fit_all(predictor, []) == []


def test_a_followed_jacobian_leads_to_the_same_values_for_less(monkeypatch):
    """One replay a step instead of one more for each value."""
    effects = ("servo_gain", "elbow", 0.8), ("viscous_friction", "shoulder", 0.5)
    predictor = predictor_of(*effects, noise_rad=NOISE_RAD)
    start = (
        PlacedEffect("servo_gain", "elbow", (1.0,)),
        PlacedEffect("viscous_friction", "shoulder", (0.05,)),
    )
    asked = []
    residuals = predictor.residuals

    def counted(models, exactly):
        asked.append(len(models))
        return residuals(models, exactly)

    monkeypatch.setattr(predictor, "residuals", counted)
    (exact,) = fit_all(predictor, [start])
    steps, asked[:] = len(asked), []
    (followed,) = fit_all(predictor, [start], followed=True)
    assert asked[0] == 3
    assert set(asked[1:]) == {1}
    assert len(asked) <= steps + 2
    assert followed.energy == pytest.approx(exact.energy, abs=3)
    for found, wanted in zip(followed.model, exact.model, strict=True):
        assert found.values == pytest.approx(wanted.values, rel=0.02)


def test_columns_of_some_effects():
    effects = ("servo_gain", "elbow", 0.8), ("viscous_friction", "shoulder", 0.5)
    predictor = predictor_of(*effects, noise_rad=NOISE_RAD)
    start = tuple(PlacedEffect(name, place, (value,)) for name, place, value in effects)
    (fit,) = fit_all(predictor, [start], steps=1)
    np.testing.assert_array_equal(fit.jacobian_of(fit.model[1:]), fit.jacobian[:, 1:])
    assert fit.jacobian_of(()).shape == (len(fit.residual), 0)


def test_values_stay_within_their_bounds():
    """Negative friction would explain a joint that moves too well."""
    predictor = predictor_of(("servo_damping", "elbow", 0.5), noise_rad=NOISE_RAD)
    (fit,) = fit_all(predictor, [(PlacedEffect("viscous_friction", "elbow", (0.05,)),)])
    assert 0 <= fit.model[0].values[0] < 1e-4


def test_a_start_at_a_bound_takes_a_known_jacobian():
    """The more of a scale a bound is, the farther inside it SciPy begins."""
    predictor = predictor_of(("armature", "elbow", 0.02), noise_rad=NOISE_RAD)
    parameter = effect("armature").parameters(predictor.plant, "elbow")[0]
    start = (PlacedEffect("armature", "elbow", (parameter.high,)),)
    (fit,) = fit_all(predictor, [start], steps=1)
    (again,) = fit_all(predictor, [start], followed=True, jacobians=[fit.jacobian])
    assert again.model[0].values[0] < parameter.high
    assert again.energy < fit.energy


@pytest.mark.parametrize("name", sorted(all_effects()))
def test_coordinates_there_and_back(name):
    """Steps of a coordinate are small and leave no value out."""
    plant = arm()
    for place in all_effects()[name].places(plant, [recorded(plant, duration_s=0.5)]):
        parameters = effect(name).parameters(plant, place)
        values = tuple(
            0.5 * (max(p.low, -1e3) + min(p.high, 1e3))
            if not p.logarithmic
            else float(np.sqrt(p.low * p.high))
            for p in parameters
        )
        model = (PlacedEffect(name, place, values),)
        coordinates = Coordinates(plant, model)
        x = coordinates.of(model)
        assert coordinates.model_at(x)[0].values == pytest.approx(values)
        low, high = coordinates.bounds()
        assert (low <= x).all()
        assert (x <= high).all()
        outside = coordinates.model_at(high + 1)[0].values
        assert outside == pytest.approx(tuple(p.high for p in parameters))


def test_coordinates_of_ratios_are_logarithms():
    plant = arm()
    model = (PlacedEffect("servo_gain", "elbow", (0.5,)),)
    assert Coordinates(plant, model).of(model) == pytest.approx([np.log(0.5)])


def test_values_that_no_data_show_do_not_slow_the_others_down():
    # a force that begins before the recording: when it began shows nowhere
    truth = ("viscous_friction", "elbow", 0.3)
    predictor = predictor_of(truth, noise_rad=0.0)
    always = PlacedEffect("external_force", "lower", (0.0, 0.0, 0.0, -1.0, 30.0))
    friction = PlacedEffect("viscous_friction", "elbow", (0.05,))
    (found,) = fit_all(predictor, [(friction, always)], steps=4)
    assert found.model[0].values[0] == pytest.approx(0.3, rel=0.02)
    assert found.model[1].values[3:] == pytest.approx((-1.0, 30.0))


def test_a_fit_keeps_no_more_jacobians_than_it_needs():
    """That where it goes on from, and those of points tried since."""
    predictor = predictor_of(("servo_gain", "elbow", 0.7), noise_rad=0.0)
    start = (PlacedEffect("servo_gain", "elbow", (1.0,)),)
    coordinates = Coordinates(predictor.plant, start)
    nudges = nudges_of(predictor, coordinates)
    for followed in (True, False):
        course = _Course(coordinates, nudges, followed, predictor.residuals)
        for x in np.linspace(0.0, 0.3, 4)[:, None]:
            course.residual(x)
            assert len(course._jacobians) <= 2
            own = course.jacobian(x)
            assert course.jacobian(x) is own
            assert len(course._jacobians) == 1
