"""How sure an answer is: of gaps that are given."""

import pytest
from made_up_search import found, judged, placed
from made_up_traces import arm

from diagnosis.conclude.answer import (
    MOST,
    TIED_NATS,
    alike,
    alternatives,
    gap,
    probability,
)
from diagnosis.search.result import VALUE_NATS, SearchResult
from diagnosis.verdict import PlacedEffect

ARM = arm()
VISCOUS, COULOMB = "viscous_friction@elbow", "coulomb_friction@elbow"
COULOMB_AT = PlacedEffect("coulomb_friction", "elbow")
GAIN, ELSEWHERE = "servo_gain@shoulder", "viscous_friction@shoulder"


def sure(*models):
    return probability(gap(found(ARM, *models), placed(models[0][1])))


def test_what_does_nearly_as_well_may_be_the_truth():
    near, far = 100 + 0.9 * TIED_NATS, 100 + 1.1 * TIED_NATS
    tied = found(ARM, (100.0, VISCOUS), (near, COULOMB), (far, GAIN))
    assert alike(tied, ARM, placed(VISCOUS)) == (COULOMB_AT,)
    assert alternatives(tied, "effects") == ((COULOMB_AT,),)


def test_where_no_model_is_exact_more_is_tolerated():
    """Residuals three times as energetic as noise tell a third."""
    near, far = 300 + 2.7 * TIED_NATS, 300 + 3.3 * TIED_NATS
    tied = found(ARM, (300.0, VISCOUS), (near, COULOMB), (far, GAIN))
    assert alternatives(tied, "effects") == ((COULOMB_AT,),)


def test_more_values_must_do_better():
    """Two nats a value: three values against one."""
    three = "stribeck_friction@elbow"
    extra = 2 * VALUE_NATS
    tied = found(ARM, (100.0, VISCOUS), (101 + TIED_NATS - extra, three))
    assert alike(tied, ARM, placed(VISCOUS)) == ()
    tied = found(ARM, (100.0, VISCOUS), (99 + TIED_NATS - extra, three))
    assert len(alike(tied, ARM, placed(VISCOUS))) == 1


def test_of_a_pair_each_effect_has_its_own_rivals():
    pair = found(ARM, (100.0, VISCOUS, GAIN), (102.0, COULOMB, GAIN))
    assert alike(pair, ARM, placed(VISCOUS)) == (COULOMB_AT,)
    assert alike(pair, ARM, placed(GAIN)) == ()
    assert alternatives(pair, "effects") == (
        (COULOMB_AT, PlacedEffect("servo_gain", "shoulder")),
    )


def test_a_more_general_form_is_no_rival():
    """Dry friction with a peak of any size contains dry friction without one."""
    general = "stribeck_friction@elbow"
    tied = found(ARM, (100.0, COULOMB), (100.0, general), (101.0, VISCOUS))
    viscous = PlacedEffect("viscous_friction", "elbow")
    assert alike(tied, ARM, placed(COULOMB)) == (viscous,)
    assert alternatives(tied, "effects") == ((viscous,),)
    other = found(ARM, (100.0, general), (101.0, COULOMB))
    assert alike(other, ARM, placed(general)) == (COULOMB_AT,)


def test_probability_grows_with_the_gap():
    gaps = [sure((100.0, VISCOUS), (100.0 + gap, COULOMB)) for gap in (0, 5, 50, 5000)]
    assert gaps == sorted(gaps)
    assert gaps[0] < 0.5
    assert 0.95 < gaps[-1] < MOST


@pytest.mark.parametrize("rival", [COULOMB, ELSEWHERE])
def test_a_tie_is_not_believed(rival):
    """Neither between effects nor between places."""
    assert sure((100.0, VISCOUS), (100.0, rival), (5000.0, GAIN)) < 0.5
    assert sure((100.0, VISCOUS), (4000.0, rival), (5000.0, GAIN)) > 0.9


def test_smaller_models_are_rivals_too():
    """All pairs may hold an effect that one effect alone does nearly without."""
    pairs = found(ARM, (100.0, VISCOUS, GAIN), (150.0, COULOMB, GAIN))
    single = {1: [judged(ARM, 104.0, VISCOUS)]}
    known = SearchResult(1e4, 100.0, {**single, **pairs.best}, 2)
    assert probability(gap(pairs, placed(GAIN))) > 0.97
    assert probability(gap(known, placed(GAIN))) < 0.7
    assert probability(gap(known, placed(VISCOUS))) == probability(
        gap(pairs, placed(VISCOUS))
    )


def test_a_gap_counts_less_where_the_best_model_is_wrong():
    right = sure((100.0, VISCOUS), (150.0, COULOMB))
    assert sure((1100.0, VISCOUS), (1150.0, COULOMB)) < right


def test_where_nothing_is_believed_there_are_no_others():
    nothing = SearchResult(102.0, 100.0, {1: []}, 0)
    assert alternatives(nothing, "none") == ()
