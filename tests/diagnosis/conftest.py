import mujoco
import numpy as np
import pytest
from audited_arm import HZ, NOISE, QUANTUM, SECONDS, motions, servo

from diagnosis.plant.plant import Plant
from diagnosis.traces.trace import Trace


@pytest.fixture(scope="module")
def plant():
    bodies = "".join(
        f'<body><joint name="{name}" axis="0 1 0" range="-100 100"/><geom size=".1"/>'
        for name in ("a", "b", "c")
    )
    spec = mujoco.MjSpec.from_string(
        f"<mujoco><worldbody>{bodies}{'</body>' * 3}</worldbody></mujoco>"
    )
    return Plant("three", spec, ("a", "b", "c"), servo())


@pytest.fixture
def trace():
    """A good one: noise, quantum and a lag of 30 ms."""
    rng = np.random.default_rng(0)
    time_s = np.arange(HZ * SECONDS) / HZ
    position = motions(time_s - 0.03) + NOISE * rng.normal(size=(len(time_s), 3))
    velocity = (motions(time_s - 0.029) - motions(time_s - 0.031)) / 0.002
    return Trace(
        "good",
        time_s,
        np.round(position / QUANTUM) * QUANTUM,
        servo(),
        velocity_rad_s=velocity + 0.01 * rng.normal(size=position.shape),
        command_rad=motions(time_s),
    )
