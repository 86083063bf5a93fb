from types import SimpleNamespace

import pytest

from diagnosis.effects.parts import PlacedEffect
from diagnosis.search.accept import without_idle_effects, without_idle_values
from diagnosis.search.result import Judged, SearchResult

PEAKED = PlacedEffect("stribeck_friction", "elbow", (1.0, 4.0, 0.1))
DRY = PlacedEffect("coulomb_friction", "elbow", (3.0,))
OIL = PlacedEffect("viscous_friction", "elbow", (2.0,))


@pytest.fixture(autouse=True)
def as_they_are(monkeypatch):
    """What is judged is judged fairly already."""

    def exactly(search, models):
        return [judged(model, search.selected) for model in models]

    monkeypatch.setattr("diagnosis.search.accept.fitted_exactly", exactly)


def judged(model, selected):
    return Judged(SimpleNamespace(model=model), selected)


def search(selected, least):
    """One that fits nothing, and believes what gains so much."""
    asked = []

    def fitted(starts):
        asked.extend(starts)
        return [judged(starts[0], selected)]

    def worth(smaller, larger):
        return smaller.selected - larger.selected > least

    return SimpleNamespace(judged=fitted, worth=worth, asked=asked, selected=selected)


def found(*models):
    best = [judged(model, 100.0 + k) for k, model in enumerate(models)]
    return SearchResult(1000.0, 50.0, {len(models[0]): best}, len(models[0]))


@pytest.mark.parametrize(("selected", "is_simple"), [(105.0, True), (140.0, False)])
def test_a_peak_must_be_worth_its_values(selected, is_simple):
    before = found((PEAKED, OIL), (DRY, OIL))
    some = search(selected, least=20.0)
    after = without_idle_values(some, before)
    assert some.asked == [(DRY, OIL)]
    if not is_simple:
        assert after is before
        return
    assert after.winner.model == (DRY, OIL)
    # the other one stays an alternative, and none is there twice
    assert [one.keys for one in after.best[2]] == [
        frozenset({DRY.key, OIL.key}),
        frozenset({PEAKED.key, OIL.key}),
    ]


@pytest.mark.parametrize("before", [found((DRY, OIL)), SearchResult(9.0, 5.0, {}, 0)])
def test_what_has_no_peak_is_not_fitted_again(before):
    some = search(1.0, least=20.0)
    assert without_idle_values(some, before) is before
    assert some.asked == []


def leaving_out(energies):
    """A search to which each model, by its effects' names, is worth so much."""

    def fitted(starts):
        return [judged(start, energies[start[0].name]) for start in starts]

    def worth(smaller, larger):
        return smaller.selected - larger.selected > 20.0

    return SimpleNamespace(judged=fitted, worth=worth)


@pytest.mark.parametrize(("alone", "chosen"), [(105.0, 1), (140.0, 2)])
def test_an_effect_without_which_the_rest_does_as_well_is_left_out(
    monkeypatch, alone, chosen
):
    """Dry friction stood for a drag at the wrong place; the drag has moved since."""
    energies = {"coulomb_friction": 900.0, "viscous_friction": alone}
    monkeypatch.setattr(
        "diagnosis.search.accept.fitted_exactly",
        lambda search, models: [judged(m, energies[m[0].name]) for m in models],
    )
    before = found((DRY, OIL))
    after = without_idle_effects(leaving_out(energies), before)
    assert after.chosen == chosen
    if chosen == 1:
        assert after.winner.model == (OIL,)
    else:
        assert after is before


def test_one_effect_alone_is_needed():
    alone = found((DRY,))
    assert without_idle_effects(search(100.0, least=1e9), alone) is alone
