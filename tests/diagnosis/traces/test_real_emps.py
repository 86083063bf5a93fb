"""A real axis whose friction others published, if its recordings are at hand."""

from pathlib import Path

import pytest

from diagnosis.conclude.estimates import estimates
from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.channels import shared_channels
from diagnosis.residuals.predictor import Predictor
from diagnosis.search.fitting import fit_all
from diagnosis.traces.pulses import pulses_of
from diagnosis.traces.read import read_traces
from diagnosis.traces.split import split
from diagnosis.traces.trace import driven_by_torques

EMPS = Path(__file__).parents[3] / ".." / "shared" / "data" / "emps"
FRICTION = (
    PlacedEffect("coulomb_friction", "carriage", (10.0,)),
    PlacedEffect("viscous_friction", "carriage", (100.0,)),
    PlacedEffect("joint_spring", "carriage", (1.0, 2.0)),
)

pytestmark = pytest.mark.skipif(
    not EMPS.is_dir(), reason="no real recordings in ../shared/data"
)


def read(name):
    plant, (trace,) = read_traces([EMPS / f"{name}.parquet"], EMPS / "emps.xml")
    return plant, trace


def test_pulses_are_found_in_the_run_that_has_them():
    assert pulses_of(*read("sweep")) == ()
    pulses = pulses_of(*read("sweep_with_pulses"))
    # one every second, half a second long
    assert len(pulses) == 25
    for k, pulse in enumerate(pulses):
        assert pulse.source == "actuator input"
        assert pulse.start_s == pytest.approx(0.344 + k, abs=0.002)
        assert pulse.end_s == pytest.approx(min(0.844 + k, 24.841), abs=0.002)
        assert pulse.torque == pytest.approx(178.0, rel=0.01)


@pytest.mark.slow
def test_friction_is_what_was_published():
    plant, traces = read_traces(
        [EMPS / "sweep.parquet", EMPS / "sweep_with_pulses.parquet"], EMPS / "emps.xml"
    )
    parts = split([driven_by_torques(trace) for trace in traces])
    learned = [*parts.fit, *parts.select]
    predictor = Predictor(plant, learned, shared_channels(plant, learned))
    predictor.calibrate()
    predictor = predictor.nominal()
    (fitted,) = fit_all(predictor, [FRICTION])
    coulomb, viscous, spring = estimates(predictor, fitted)
    # another estimator on one of the runs: 80 % intervals may miss it by a little
    assert coulomb["torque"].value == pytest.approx(20.39, rel=0.07)
    assert viscous["coefficient"].low <= 203.5 <= viscous["coefficient"].high
    force = spring["stiffness"].value * (spring["rest"].value - 0.12)
    assert force == pytest.approx(3.16, rel=0.2)
