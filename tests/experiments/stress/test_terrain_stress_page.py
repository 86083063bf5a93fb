import pytest

from experiments.stress.curves import curves_of, half_text, severity_text
from experiments.stress.figure import comparison_figure, heat_map_figure
from experiments.stress.page import (
    cause_rows,
    cell_rows,
    half_rows,
    stress_answer,
)
from experiments.terrain_stress import worst_falls


def trial(gait, number, distance_m, cause=""):
    return {
        "gait": gait, "number": number, "distance_m": distance_m, "time_s": 4.0,
        "end": "fall" if cause else "", "cause": cause,
    }  # fmt: skip


def cell(family, severity, falls, gait="start", world="sim"):
    """Four trials; those that fall do so after 10, 20 ... cm."""
    trials = [
        trial(gait, k, 0.1 * (k + 1), "slip") if k < falls else trial(gait, k, 1.0)
        for k in range(4)
    ]
    return {
        "robot": "nao", "world": world, "family": family, "severity": severity,
        "trials": trials,
    }  # fmt: skip


def joined(first, second):
    return {**first, "trials": first["trials"] + second["trials"]}


@pytest.fixture(scope="module")
def cells():
    """A gait that falls more and more, and one that never does."""
    return [
        joined(cell(family, severity, falls), cell(family, severity, 0, "sure"))
        for family, severity, falls in (
            ("flat", 0.0, 0),
            ("lumps", 0.002, 0), ("lumps", 0.004, 1), ("lumps", 0.008, 4),
            ("friction", 0.4, 1), ("friction", 0.2, 2), ("friction", 0.1, 4),
        )
    ]  # fmt: skip


@pytest.fixture(scope="module")
def curves(cells):
    return curves_of(cells)


def test_a_curve_for_each_gait_and_family(curves):
    assert [(curve["family"], curve["gait"]) for curve in curves] == [
        ("flat", "start"), ("flat", "sure"), ("lumps", "start"), ("lumps", "sure"),
        ("friction", "start"), ("friction", "sure"),
    ]  # fmt: skip
    rungs = curves[2]["rungs"]
    assert [rung["falls"] for rung in rungs] == [0, 1, 4]
    # the fall after 10 cm and three times 100 cm, in 4 s
    assert rungs[1]["speed_cm_s"] == pytest.approx((2.5 + 3 * 25) / 4)
    assert rungs[2]["distance_to_fall_m"] == pytest.approx(0.25)
    assert rungs[2]["causes"] == {"slip": 4}
    assert rungs[0]["distance_to_fall_m"] is None
    # Wilson 1927 for 4 of 4: from n / (n + z^2)
    assert rungs[2]["fall_rate_low"] == pytest.approx(4 / (4 + 1.96**2), abs=1e-4)


def test_numbers_are_read_in_millimetres_and_degrees():
    assert severity_text(0.0063, "m") == "6.3 mm"
    assert severity_text(0.0872665, "rad") == "5°"
    assert severity_text(0.15, "1") == "0.15"
    assert severity_text(0.0, None) == "-"


def test_a_severity_that_no_rung_reaches_is_said_in_words(curves):
    lumps, never, ice = half_text(curves[2]), half_text(curves[3]), half_text(curves[5])
    assert lumps.startswith("4.")
    assert "mm (" in lumps
    assert never == "not reached (up to 8 mm)"
    # the harder friction is the smaller one
    assert ice == "not reached (down to 0.1)"
    easy = {**curves[5], "half": {**curves[5]["half"], "beyond": "<", "severity": 0.4}}
    assert half_text(easy) == "above 0.4"


def test_tables_have_their_rows(curves):
    halves = half_rows(curves)
    assert [row[2:4] for row in halves] == [
        ["start", "lumps"], ["sure", "lumps"], ["start", "friction"],
        ["sure", "friction"],
    ]  # fmt: skip
    assert len(cell_rows(curves)) == 2 + 6 + 6
    by_family = {tuple(row[2:4]): row[4:] for row in cause_rows(curves)}
    assert by_family["start", "lumps"][:2] == ["5", "5"]
    assert ("sure", "lumps") not in by_family


def test_the_answer_speaks_of_each_gait(curves):
    start, sure = stress_answer(curves)
    assert "start (nao) falls in 12 of 28 trials, 0 of 4 on flat ground" in start
    assert "sure (nao) falls in 0 of 28 trials" in sure
    assert "lumps not reached (up to 8 mm)" in sure


def test_the_worst_are_the_early_falls_on_mild_ground(cells):
    worst = worst_falls(cells, "start", 3)
    assert [place.label for place, _ in worst] == ["friction-0.4", "lumps-0.004"]
    assert [trial.distance_m for _, trial in worst] == [0.1, 0.1]
    assert worst_falls(cells, "sure", 3) == []
    assert len(worst_falls(cells, "start", 1)) == 1


def test_pictures_show_every_rung_and_gait(curves):
    own = [curve for curve in curves if curve["gait"] == "start"]
    panel, _ = heat_map_figure(own).axes
    texts = [text.get_text() for text in panel.texts]
    assert texts[:3] == ["0/4\n2 mm", "1/4\n4 mm", "4/4\n8 mm"]
    assert "0/4 fall" in panel.get_title()
    figure = comparison_figure(curves)
    (panel,) = figure.axes
    labels = [label.get_text() for label in panel.get_yticklabels()]
    assert labels == ["lumps\n2 mm to 8 mm", "friction\n0.4 to 0.1"]
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == ["start", "sure"]
