"""Proposes the recording that would best distinguish between two answers."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from diagnosis.conclude.answer import rivals
from diagnosis.effects.library import effect
from diagnosis.motions.shapes import MOTIONS, Motion
from diagnosis.plant.plant import Plant
from diagnosis.replay.replay import replay
from diagnosis.residuals.predictor import Model
from diagnosis.residuals.replays import variants_of
from diagnosis.search.result import SearchResult
from diagnosis.traces.trace import Trace
from diagnosis.traces.usage import Usage
from diagnosis.traces.windows import Run
from diagnosis.verdict import NextExperiment, PlacedEffect

TICK_S = 0.01
"""Control tick of the proposed motion [s]."""

REACH = 0.8
"""Share of each joint's range in the recordings that the proposed motion uses."""

STIFFER = "the same with servos of twice the stiffness and half the damping"
"""Words that the report uses for a motion with changed servo gains."""


def next_experiment(
    plant: Plant, found: SearchResult, traces: Sequence[Trace]
) -> NextExperiment | None:
    """The motion to record next: the two best models predict it most differently.

    This is the criterion of Hunter and Reiner 1965 (T-optimality). The motion stays
    within the range of the recordings `traces`. None if no other model is plausible, or
    if a recording has no position commands.
    """
    winner, others = found.winner, rivals(found)
    uncommanded = any(trace.command_rad is None for trace in traces)
    if winner is None or not others or uncommanded:
        return None
    pair = winner.model, others[0].model
    usage = Usage.of(plant, traces)
    place = next((p.place for p in pair[0] if p.place in plant.joints), None)
    difference = {
        motion: _difference(plant, pair, _trace(plant, usage, motion, traces[0]))
        for motion in MOTIONS
    }
    best = max(difference, key=lambda motion: difference[motion])
    trace, words, apart = traces[0], best.words, difference[best]
    gains = {"kp_nm_rad": 2 * trace.servo.kp_nm_rad}
    gains["kd_nm_s_rad"] = 0.5 * trace.servo.kd_nm_s_rad
    trace = replace(trace, servo=replace(trace.servo, **gains))
    stiffer = _difference(plant, pair, _trace(plant, usage, best, trace))
    if stiffer > 2 * apart:
        words, apart = f"{best.words}; {STIFFER}", stiffer
    names = [" with ".join(map(_words, model)) for model in pair]
    size = f"{float(f'{1e3 * apart:.2g}'):g}"  # two digits, without an exponent
    why = f"there {names[0]} and {names[1]} differ by {size} mrad rms"
    return NextExperiment(words, place, why)


def _words(placed: PlacedEffect) -> str:
    """An effect with its place: "dry friction at elbow"."""
    words = effect(placed.name).words
    return f"{words.label} at {placed.place}" if words.place_kind else words.label


def _trace(plant: Plant, usage: Usage, motion: Motion, like: Trace) -> Trace:
    """A trace in which all joints follow a motion within the range used so far."""
    time_s = np.arange(0, motion.duration_s, TICK_S)
    middle = (usage.low_rad + usage.high_rad) / 2
    half = REACH * (usage.high_rad - usage.low_rad) / 2
    command = middle + half * motion.shape(time_s, motion.duration_s)[:, None]
    return Trace("next", time_s, command, like.servo, command_rad=command)


def _difference(plant: Plant, models: Sequence[Model], trace: Trace) -> float:
    """Rms difference [rad] between the positions that two models predict."""
    start = Run(trace, trace.position_rad[0], np.zeros(len(plant.joints)))
    position = replay([start], variants_of(plant, models))[0].position_rad
    wrong = position[0] - position[1]
    return float(np.sqrt(np.mean(wrong[np.isfinite(wrong)] ** 2)))
