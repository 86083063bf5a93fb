import numpy as np
import pytest
from known_arms import CHANNELS
from made_up_traces import arm, recorded

from diagnosis.residuals import signatures as tries
from diagnosis.residuals.predictor import Predictor
from diagnosis.residuals.signatures import signatures
from diagnosis.traces.usage import Usage


@pytest.mark.parametrize("few", [True, False])
def test_limits_are_tried_joint_by_joint_where_joints_are_few(few, monkeypatch):
    """A shoulder that collapses takes the elbow along: together they tell little."""
    if not few:
        monkeypatch.setattr(tries, "FEW_JOINTS", 1)
    predictor = Predictor(arm(), [recorded(arm(), duration_s=2.0)], CHANNELS)
    predictor.calibrate()
    usage = Usage.of(predictor.plant, predictor.traces)
    found = signatures(predictor, (), usage, names=["torque_limit"])
    models = [(), *((one.placed,) for one in found)]
    nominal, *alone = predictor.residuals(models)
    changes = [
        one.change - (own - nominal)[one.rows]
        for one, own in zip(found, alone, strict=True)
    ]
    assert len(found) == 6
    assert all(len(one.rows) == len(nominal) for one in found) == few
    largest = max(float(np.abs(one).max()) for one in changes)
    assert (largest < 1e-6) == few
