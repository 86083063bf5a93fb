"""Benchmark: time of the control loop with and without an action transformer.

The same 150 walks are computed in turn in the plain sim and in the sim whose commands
pass through an SGAT transformer with block noise. The transformer computes everything,
but with a smoothing of 0 it returns the gait's own commands, so that both loops do the
same physics. Its models have their usual size and are fitted to few walks, which does
not change the time that they take.
"""

import dataclasses
from functools import partial

import numpy as np

import robots
import terrain
import worlds
from benchmarks.ratios import judged, seconds
from experiments.grounded_walks.courses import SimPlace
from experiments.grounded_walks.walks import walk
from experiments.walking import TrialRules, walk_trials
from sgat.models.config import ForwardConfig, NetworkConfig
from sgat.models.transition_models import ForwardModel, InverseModel
from sgat.noise import BlockNoise
from sgat.transformers.action_transformer import ActionTransformer
from sgat.walks.gait_cloud import GaitCloud
from sgat.walks.walk_senses import leg_senses
from sgat.walks.wrapped_worlds import GroundedWorld
from walk_engine import gaits

ROBOTS = 150
TICKS = 200
ROUNDS = 7
BLOCK_TICKS, MEMBERS = 50, 4
MOST = 1.15
"""Largest ratio of times, with transformer to without, that passes the benchmark."""


def measure() -> list[float]:
    """Time with action transformer divided by the time without, in each round."""
    description = robots.get("nao")
    seeds = np.random.SeedSequence(1).spawn(ROBOTS)
    grounds = [terrain.make("flat", 0)] * ROBOTS
    plain = worlds.make("sim", description, grounds, seeds)
    inside = worlds.make("sim", description, grounds, seeds)
    grounded = GroundedWorld(inside, leg_senses(description), _transformer(), seeds)
    walks = [gaits.get("start")] * ROBOTS
    rules = TrialRules(limit_s=TICKS * worlds.TICK_S)
    ratios = []
    for _ in range(ROUNDS + 1):
        with_grounding = seconds(partial(walk_trials, grounded, walks, rules))
        ratios.append(
            with_grounding / seconds(partial(walk_trials, plain, walks, rules))
        )
    return ratios[1:]


def report(ratios: list[float]) -> tuple[str, bool]:
    """Text that reports the ratios of times, and whether their median passes."""
    line, passes = judged("time against the ungrounded one", ratios, "at most", MOST)
    return (
        f"grounded control loop of {ROBOTS} robots, {TICKS} ticks, {ROUNDS} rounds\n"
        f"{line}"
    ), passes


def _transformer() -> ActionTransformer:
    """Fit an SGAT transformer like that of the NAO study: ensemble and block noise."""
    description = robots.get("nao")
    senses = leg_senses(description)
    vectors = GaitCloud().draw(gaits.get("start"), 8, np.random.SeedSequence(2))
    _, noted = walk(
        SimPlace(), description, vectors, np.random.SeedSequence(3), (0.02,)
    )
    seen = dataclasses.replace(noted, state=noted.state[:, : senses.sim_columns])
    seed = np.random.SeedSequence(4)
    forward = ForwardModel(ForwardConfig(epochs=3, members=MEMBERS)).fit(noted, seed)
    inverse = InverseModel(NetworkConfig(epochs=3)).fit(seen, seed)
    bound = np.ones(len(senses.joints))
    law = BlockNoise(forward.residuals(noted), noted.episode, BLOCK_TICKS)
    return ActionTransformer(
        forward,
        inverse,
        -bound,
        bound,
        law,
        smoothing=0.0,
        inverse_columns=senses.sim_columns,
    )
