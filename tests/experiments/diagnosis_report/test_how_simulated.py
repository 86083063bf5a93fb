"""Which file the report names for an effect that MuJoCo lacks."""

import pytest

from diagnosis.verdict import Found, When
from experiments.diagnosis_report.corrected_files import how_simulated

KICK = When("burst", 1.0, 1.2, "kicked")


@pytest.mark.parametrize(
    ("found", "says"),
    [
        (Found("armature", "hinge", {}, 0.9), ""),
        (Found("backlash", "hinge", {}, 0.9, native=False), "corrected_laws.py adds"),
        (
            Found("uneven_ground", "world", {}, 0.9, native=False),
            "no file for other simulators does: it says how high bumps are, not where.",
        ),
        (
            Found("external_force", "rod", {}, 0.9, when=KICK, native=False),
            "no file for other simulators does: it happened in kicked only.",
        ),
    ],
    ids=lambda one: getattr(one, "name", ""),
)
def test_the_file_or_the_reason(found, says):
    told = how_simulated(found)
    assert says in told
    assert bool(told) == bool(says)
