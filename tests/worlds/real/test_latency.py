"""Commands that act later, by exactly the latency."""

import mujoco
import numpy as np
import pytest

from worlds import WorldOptions
from worlds.real.robot import BulletRobot
from worlds.rollouts import DelayLine
from worlds.sim.world import mujoco_model

TICKS = 12
STEPS = 5  # of 2 ms in a tick


def acting(latency_steps, steps_per_tick, ticks):
    """The command that acts in each physics step, if command k is given at tick k."""
    line = DelayLine(latency_steps, steps_per_tick)
    line.reset(np.array(-1.0))
    steps = []
    for tick in range(ticks):
        for command, count in line.tick(np.array(float(tick))):
            assert count > 0
            steps += [float(command)] * count
    return steps


@pytest.mark.parametrize("steps_per_tick", [1, 2, 5, 20])
@pytest.mark.parametrize("latency_steps", [0, 1, 2, 3, 4, 5, 6, 18, 40])
def test_delay_line_shifts_by_whole_steps(latency_steps, steps_per_tick):
    total = TICKS * steps_per_tick
    given = [step // steps_per_tick for step in range(total)]
    expected = ([-1.0] * latency_steps + given)[:total]
    assert acting(latency_steps, steps_per_tick, TICKS) == expected


def test_reset_forgets_commands():
    line = DelayLine(7, 5)
    line.reset(np.array(1.0))
    list(line.tick(np.array(2.0)))
    line.reset(np.array(3.0))
    assert [float(command) for command, _ in line.tick(np.array(4.0))] == [3.0, 3.0]


@pytest.fixture(scope="module")
def kick(crouch):
    """(before, after): a command to hold, and one that moves every joint."""
    return crouch, crouch + 0.1 * np.cos(np.arange(len(crouch)))


def held(kick, late_steps):
    """Command and number of steps, tick by tick, if the kick acts so late."""
    before, after = kick
    for first in range(0, TICKS * STEPS, STEPS):
        late = min(max(late_steps - first, 0), STEPS)
        parts = [(before, late), (after, STEPS - late)]
        yield [part for part in parts if part[1]]


def plain_mujoco(nao, kick, late_steps):
    """Joint positions (ticks, joints) out of one step after the other."""
    model = mujoco_model(nao, WorldOptions(fixed_base=True), ground=None)
    data = mujoco.MjData(model)
    data.qpos[:] = kick[0]
    mujoco.mj_forward(model, data)
    rows = []
    for parts in held(coupled(nao, kick), late_steps):
        for command, steps in parts:
            data.ctrl[:] = command
            for _ in range(steps):
                mujoco.mj_step(model, data)
        rows.append(data.qpos.copy())
    return np.array(rows)


def plain_bullet(nao, kick, late_steps, flat):
    robot = BulletRobot(nao, flat, WorldOptions(fixed_base=True))
    try:
        robot.reset(kick[0], 1.0)
        parts = held(coupled(nao, kick), late_steps)
        return np.array([robot.step(part)[-2] for part in parts])
    finally:
        robot.close()


def coupled(nao, kick):
    """The commands as the one motor of a pair takes them."""
    commands = [command.copy() for command in kick]
    for first, second in nao.coupled:
        for command in commands:
            command[[first, second]] = command[[first, second]].mean()
    return commands


@pytest.mark.parametrize("latency_s", [0.0, 0.002, 0.03, 0.036])
@pytest.mark.parametrize("name", ["sim", "real"])
def test_response_comes_later_by_exactly_that(
    name, nao, kick, flat, make_world, latency_s
):
    world = make_world(name, fixed_base=True, latency_s=latency_s)
    before, after = kick
    world.reset(before[None])
    response = [world.step(after[None]).position_rad[0] for _ in range(TICKS)]
    late_steps = round(latency_s / 0.002)
    if name == "sim":
        expected = plain_mujoco(nao, kick, late_steps)
        other = plain_mujoco(nao, kick, late_steps + 1)
    else:
        expected = plain_bullet(nao, kick, late_steps, flat)
        other = plain_bullet(nao, kick, late_steps + 1, flat)
    np.testing.assert_array_equal(response, expected)
    assert np.abs(response[-1] - other[-1]).max() > 1e-4
