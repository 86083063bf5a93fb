"""Why some effects are not drawn on a pendulum, and why its gains are changed."""

import numpy as np
import pytest

from worlds.hidden.effects import Hidden
from worlds.hidden.plant import hidden_plant
from worlds.hidden.run import Clock, run_hidden

ROWS = 601
TIME_S = np.arange(ROWS) * 0.01
SWING = np.stack([0.6 * np.sin(3 * TIME_S) * np.sin(2 * TIME_S)], axis=1)


def swing_rad(effect, stiffness=1.0, damping=1.0):
    """What a pendulum's encoder says once the start is forgotten."""
    plant = hidden_plant("pendulum").with_gains(stiffness, damping)
    clock = Clock(0.0005, np.arange(ROWS) * 20, 0)
    start_rad, feed = SWING[0], lambda row, sense: SWING[row]
    nobody = np.random.SeedSequence(0)
    hidden = [Hidden(*effect)]
    run = run_hidden(plant, hidden, "mujoco", clock, feed, start_rad, nobody)
    return run.encoder_rad[500:, 0]


@pytest.mark.parametrize(
    ("drawn_one", "twin"),
    [
        (
            ("command_latency", "commands", {"delay": 0.02}),
            ("sensor_delay", "encoders", {"delay": 0.02}),
        ),
        (
            ("viscous_friction", "swing", {"coefficient": 0.8 * 0.3**2}),
            ("drag", "link", {"coefficient": 0.8}),
        ),
        (
            ("encoder_offset", "swing", {"offset": 0.05}),
            ("ground_slope", "world", {"pitch": -0.05, "roll": 0.0}),
        ),
    ],
)
def test_effects_that_are_not_drawn_act_as_others_do(drawn_one, twin):
    assert np.abs(swing_rad(drawn_one) - swing_rad(twin)).max() < 1e-4


def test_other_gains_tell_what_one_set_cannot():
    damping = ("servo_damping", "swing", {"factor": 1.2})
    friction = ("viscous_friction", "swing", {"coefficient": 0.2 * 0.2})
    assert np.abs(swing_rad(damping) - swing_rad(friction)).max() < 1e-4
    soft = [swing_rad(effect, 0.5, 0.5) for effect in (damping, friction)]
    assert np.abs(soft[0] - soft[1]).max() > 2e-3
