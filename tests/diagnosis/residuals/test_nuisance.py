"""Small mismatch of the nominal model: likely values, also beside effects."""

import zlib

import numpy as np
import pytest
from made_up_traces import arm
from scipy.optimize import lsq_linear

from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.coordinates import Coordinates
from diagnosis.residuals.small_mismatch import fit_point, nuisance_fit
from diagnosis.residuals.small_mismatch.nuisance import Nuisance
from diagnosis.residuals.small_mismatch.nuisance_fit import ENOUGH_NATS, NuisanceFit
from diagnosis.residuals.small_mismatch.usual_errors import USUAL

PLANT = arm()
ROWS = 300
GAIN = "servo_gain@elbow"
OTHERS = "coulomb_friction@elbow", "servo_damping@elbow"


class Linear:
    """Residuals that are linear in how far values are from the usual, in its units."""

    def __init__(self, true, noise=1.0, reach=30.0, seed=0, alike=(), bend=0.0, off=0):
        """Where the errors `true`, by "effect@place", are missing in the model.

        What one of `alike` changes is nearly the sum of what the others do. What any
        changes is turned into other directions by `bend` for each standard deviation
        of the first, so that residuals are not linear. Simulations are wrong by `off`
        (noises) times the distance from the model whose error is corrected.
        """
        random = np.random.default_rng(seed)
        self.nuisance = Nuisance.of(PLANT, (), ROWS)
        keys = [self.nuisance.key(i) for i in range(len(self.nuisance.units))]
        self.changes = reach * random.standard_normal((len(keys), ROWS)) / ROWS**0.5
        if alike:
            first, *others = [keys.index(key) for key in alike]
            self.changes[first] *= 0.1
            self.changes[first] += self.changes[others].sum(axis=0)
        self.true = np.array([true.get(key, 0.0) for key in keys])
        self.noise = noise * random.standard_normal(ROWS)
        self.index = {key: keys.index(key) for key in keys}
        self.turn = bend * random.standard_normal(ROWS) * self.changes.std()
        self.error = off * random.standard_normal(ROWS)
        self.corrected = 0.0

    def far(self, model):
        """(k,) how far a model's values are from neutral ones."""
        far = np.zeros(len(self.true))
        for placed in model:
            neutral = self.nuisance.parameters[self.index[placed.key]]
            for unit, own in zip(self.nuisance.units, [placed] * 99, strict=False):
                if unit.key != placed.key:
                    continue
                k = self.nuisance.units.index(unit)
                i = int(
                    np.argmax(
                        [
                            a != p.neutral
                            for a, p in zip(unit.values, neutral, strict=True)
                        ]
                    )
                )
                one = neutral[i]
                log = (lambda v: np.log(v)) if one.logarithmic else (lambda v: v)
                size = log(unit.values[i]) - log(one.neutral)
                far[k] = (log(own.values[i]) - log(one.neutral)) / size
        return far

    def ask(self, models):
        return np.stack([self._left(self.far(model)) for model in models])

    def _left(self, far):
        bent = np.sum(self.true**2) - np.sum(far**2)
        wrong = np.linalg.norm(far) - self.corrected
        straight = self.noise + (self.true - far) @ self.changes
        return straight + bent * self.turn + wrong * self.error

    def correct(self, model):
        self.corrected = float(np.linalg.norm(self.far(model)))

    def at(self, sizes, found):
        """The small mismatch found, with other sizes of some."""
        some = found.sizes.copy()
        for key, size in sizes.items():
            some[self.index[key]] = size
        return found.at(some).beside(())


def test_errors_are_found():
    world = Linear(
        {GAIN: 1.5, "servo_gain@shoulder": -1.2, "coulomb_friction@elbow": 2.0}
    )
    found = NuisanceFit(world.ask, world.correct, ()).fitted(world.nuisance)
    np.testing.assert_allclose(found.sizes, world.true, atol=0.3)


def test_they_are_what_is_likeliest():
    """As ridge regression within bounds, in which each is worth its own square."""
    world = Linear({GAIN: 1.5}, reach=1.0)
    found = NuisanceFit(world.ask, world.correct, ()).fitted(world.nuisance)
    changes = -found.changes.whole()
    left = world.ask([()])[0]
    rows = np.vstack([changes.T, np.eye(len(changes))])
    low, high = found.bounds()
    wanted = lsq_linear(
        rows, np.append(left, np.zeros(len(changes))), (low - 1e-9, high)
    )
    energies = [
        np.sum((left + found.changes.by(sizes - found.sizes)) ** 2) + np.sum(sizes**2)
        for left in world.ask([found.beside(())])
        for sizes in (found.sizes, wanted.x)
    ]
    assert energies[0] < energies[1] + 2 * ENOUGH_NATS


def test_errors_are_found_where_what_they_change_is_not_linear():
    """What they change at none does not lead to the noise; simulated again it does."""
    world = Linear({GAIN: 1.5, "servo_gain@shoulder": -2.0}, reach=90.0, bend=1.0)
    found = NuisanceFit(world.ask, world.correct, ()).fitted(world.nuisance)
    (left,) = world.ask([found.beside(())])
    assert np.mean(left**2) < 1.5
    np.testing.assert_allclose(found.sizes, world.true, atol=0.5)


def test_their_own_integration_error_is_no_error_of_theirs():
    """It is three times the noise beside the right values; so they stayed at none."""
    world = Linear({GAIN: 2.5}, off=1.2)
    found = NuisanceFit(world.ask, world.correct, ()).fitted(world.nuisance)
    assert found.sizes[world.index[GAIN]] == pytest.approx(2.5, abs=0.3)
    world = Linear({GAIN: 2.5}, off=1.2)
    stale = NuisanceFit(world.ask, lambda model: None, ()).fitted(world.nuisance)
    assert not stale.sizes.any()


def test_small_errors_do_not_stand_for_what_they_cannot_explain():
    world = Linear({GAIN: 1.5}, noise=3.0)
    found = NuisanceFit(world.ask, world.correct, ()).fitted(world.nuisance)
    assert not found.sizes.any()


@pytest.mark.parametrize("falls", [0.025, 0.05, 0.1])
def test_a_robot_is_predicted_by_errors_and_values_whatever_is_left(falls, monkeypatch):
    """Three times the noise is left; the elbow's gain is a value, not an error."""
    monkeypatch.setattr(nuisance_fit, "SETTLED", 1 - falls)
    world = Linear({GAIN: 4.0, "servo_gain@shoulder": -1.2}, noise=3.0, bend=0.2)
    start = (PlacedEffect("servo_gain", "elbow", (1.0,)),)
    fit = NuisanceFit(world.ask, world.correct, start)
    found, model = fit.fitted_with_values(world.nuisance)
    (left,) = world.ask([(*found.beside({GAIN}), *model)])
    assert np.mean(left**2) < 1.1 * np.mean(world.noise**2)
    sizes = found.sizes + world.far(model)
    np.testing.assert_allclose(sizes, world.true, atol=0.5)


CONSTANTS = {
    "NUDGE": nuisance_fit,
    "NUDGE_X": nuisance_fit,
    "FLAT": nuisance_fit,
    "MOST_STEPS": nuisance_fit,
    "MOST_SEEN": nuisance_fit,
    "CLOSER": nuisance_fit,
    "ENOUGH": nuisance_fit,
    "ENOUGH_NATS": nuisance_fit,
    "NEAR": fit_point,
    "NEAR_X": fit_point,
}


@pytest.mark.parametrize("factor", [0.5, 1.0, 2.0])
@pytest.mark.parametrize("name", CONSTANTS)
def test_a_factor_of_two_in_a_constant_of_the_fit_does_not_matter(
    name, factor, monkeypatch
):
    """Errors alone, beside values, and more than errors can explain."""
    value = getattr(CONSTANTS[name], name)
    monkeypatch.setattr(CONSTANTS[name], name, type(value)(value * factor))
    world = Linear({GAIN: 1.5, "servo_gain@shoulder": -2.0}, reach=90.0, bend=0.5)
    found = NuisanceFit(world.ask, world.correct, ()).fitted(world.nuisance)
    np.testing.assert_allclose(found.sizes, world.true, atol=0.5)
    world = Linear({GAIN: 4.0, "servo_gain@shoulder": -1.2}, noise=3.0, bend=0.2)
    start = (PlacedEffect("servo_gain", "elbow", (1.0,)),)
    fit = NuisanceFit(world.ask, world.correct, start)
    found, model = fit.fitted_with_values(world.nuisance)
    np.testing.assert_allclose(found.sizes + world.far(model), world.true, atol=0.5)
    world = Linear({GAIN: 1.5}, noise=3.0)
    found = NuisanceFit(world.ask, world.correct, ()).fitted(world.nuisance)
    assert not found.sizes.any()


class Rough(Linear):
    """Residuals to which each change, however small, adds something else at random."""

    def _left(self, far):
        random = np.random.default_rng(zlib.crc32(far.tobytes()))
        return super()._left(far) + 0.8 * random.standard_normal(ROWS)


@pytest.fixture(scope="module")
def rough_worlds():
    true = {GAIN: 4.0, "servo_gain@shoulder": -2.0, OTHERS[0]: 1.0}
    return [Rough(true, seed=seed, bend=0.3) for seed in range(6)]


def off(worlds, settle):
    """Rms error, in standard deviations, of errors and values found together."""
    start, far = (PlacedEffect("servo_gain", "elbow", (1.0,)),), []
    for world in worlds:
        fit = NuisanceFit(world.ask, world.correct, start)
        found, model = settle(fit, world.nuisance)
        far.append(found.sizes + world.far(model) - world.true)
    return np.sqrt(np.mean(np.square(far)))


@pytest.mark.parametrize("factor", [0.5, 1.0, 2.0])
@pytest.mark.parametrize("name", ["WIDE", "STILL", "MOST_ROUNDS", "NUDGE_X", "FLAT"])
def test_errors_and_values_settle_where_simulations_are_rough(
    name, factor, rough_worlds, monkeypatch
):
    value = getattr(nuisance_fit, name)
    monkeypatch.setattr(nuisance_fit, name, type(value)(value * factor))
    assert off(rough_worlds, NuisanceFit.settled_with_values) < 0.075


def test_differences_to_one_side_do_not_lead_there(rough_worlds):
    assert off(rough_worlds, NuisanceFit.fitted_with_values) > 0.09


def test_fits_from_other_values_end_at_the_same_where_nothing_is_rough():
    """Elsewhere they end apart, each where another step would not help."""
    start = (PlacedEffect("servo_gain", "elbow", (1.0,)),)

    def apart(kind):
        far = []
        for seed in range(6):
            world = kind({GAIN: 1.0, "servo_gain@shoulder": -2.0}, seed=seed)
            fit = NuisanceFit(world.ask, world.correct, start)
            found, model = fit.settled_with_values(world.nuisance)
            x = Coordinates(PLANT, model).of(model)
            fit = NuisanceFit(world.ask, world.correct, model)
            far.append(fit.ends(found, x + np.array([[-0.02], [0.02]])) - x)
        return np.sqrt(np.mean(np.square(far)))

    assert apart(Rough) > 5 * apart(Linear)


@pytest.mark.parametrize("room", [1, 100])
def test_it_does_not_matter_how_many_changes_are_simulated_at_once(
    room, rough_worlds, monkeypatch
):
    usual = off(rough_worlds[:1], NuisanceFit.settled_with_values)
    monkeypatch.setattr(nuisance_fit, "AT_ONCE", room)
    assert off(rough_worlds[:1], NuisanceFit.settled_with_values) == usual


SHARES = tuple(one for one in nuisance_fit.TRIED if not one[1])


@pytest.mark.parametrize("factor", [0.5, 1.0, 2.0])
@pytest.mark.parametrize(
    ("world", "tried"),
    [
        (dict(reach=30.0), ("TRIED", "LAST_TRIED")),
        (dict(reach=3.0, alike=(GAIN, *OTHERS)), ("LAST_TRIED",)),
    ],
)
def test_damped_steps_go_where_no_share_of_a_linear_step_does(
    world, tried, factor, monkeypatch
):
    """Errors that the data hardly tell go far, where nothing is as predicted."""

    def left():
        one = Linear({GAIN: 0.5, "servo_gain@shoulder": -0.5}, bend=300.0, **world)
        fit = NuisanceFit(one.ask, one.correct, ())
        found, _ = fit.fitted_with_values(one.nuisance)
        return np.mean(one.ask([found.beside(())])[0] ** 2)

    for name in tried:
        steps = [(share, factor * by) for share, by in getattr(nuisance_fit, name)]
        monkeypatch.setattr(nuisance_fit, name, steps)
    assert left() < 1.1
    for name in tried:
        monkeypatch.setattr(nuisance_fit, name, SHARES)
    assert left() > 2.0


def test_no_error_is_larger_than_usual_and_friction_is_never_negative():
    world = Linear({GAIN: 9.0, "coulomb_friction@elbow": -2.0}, reach=3.0)
    found = NuisanceFit(world.ask, world.correct, ()).fitted(world.nuisance)
    sizes = found.sizes
    assert sizes[world.index[GAIN]] == pytest.approx(USUAL)
    assert sizes[world.index["coulomb_friction@elbow"]] == pytest.approx(0.0, abs=1e-6)
    (left,) = world.ask([found.beside(())])
    gains = {one.key: gain for one, gain in found.unusual(left)}
    assert list(gains) == [GAIN]
    right = world.at({GAIN: 9.0}, found)
    both = [0.5 * float(np.sum(one**2)) for one in (left, *world.ask([right]))]
    assert gains[GAIN] == pytest.approx(both[0] - both[1], rel=0.3)


def test_what_a_model_has_is_no_small_error_too():
    world = Linear({GAIN: 9.0})
    true = (PlacedEffect("servo_gain", "elbow", (float(np.exp(9 * 0.03)),)),)
    found = NuisanceFit(world.ask, world.correct, true).fitted(world.nuisance)
    assert found.sizes[world.index[GAIN]] == 0.0
    assert GAIN not in {one.key for one in found.beside({GAIN})}
    (left,) = world.ask([(*found.beside({GAIN}), *true)])
    assert not found.unusual(left)
    # what a value of its own would change is known all the same
    assert np.abs(found.changes.whole()[world.index[GAIN]]).max() > 0


def test_a_slightly_wrong_value_of_a_model_hides_no_small_errors():
    """Its gain is one standard deviation off, which changes 60 noises in all."""
    world = Linear({GAIN: 9.0, "servo_gain@shoulder": -2.0}, reach=60.0)
    wrong = (PlacedEffect("servo_gain", "elbow", (float(np.exp(8 * 0.03)),)),)
    found = NuisanceFit(world.ask, world.correct, wrong).fitted(world.nuisance)
    k = world.index["servo_gain@shoulder"]
    assert found.sizes[k] == pytest.approx(-2.0, abs=0.3)
    assert np.abs(np.delete(found.sizes, k)).max() < 0.3
    # something else is missing, which no value of the model explains
    loud = Linear({GAIN: 9.0, "servo_gain@shoulder": -2.0}, reach=60.0, noise=3.0)
    assert (
        not NuisanceFit(loud.ask, loud.correct, wrong).fitted(loud.nuisance).sizes.any()
    )


def test_small_errors_move_when_the_model_does():
    world = Linear({GAIN: 9.0})
    before = NuisanceFit(world.ask, world.correct, ()).fitted(world.nuisance)
    true = (PlacedEffect("servo_gain", "elbow", (float(np.exp(9 * 0.03)),)),)
    after = NuisanceFit(world.ask, world.correct, true).moved(before)
    (left,) = world.ask([(*after.beside({GAIN}), *true)])
    assert np.mean(left**2) < 1.5
    (wrong,) = world.ask([(*before.beside({GAIN}), *true)])
    assert np.mean(wrong**2) > np.mean(left**2)
