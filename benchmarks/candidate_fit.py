"""Benchmark: time to fit the friction of a joint, diagnosis against mujoco.sysid.

A candidate is viscous and dry friction of one joint of the NAO; both programs fit each
candidate to the same recording. The diagnosis fits the candidates of all joints side by
side: each replay and each finite difference is a row of one batch. mujoco.sysid fits
one candidate after the other with its own finite differences, on as many threads. Both
run until they converge; the benchmark checks that both find the hidden friction.
"""

import contextlib
import io
import tempfile
from functools import partial
from pathlib import Path

import numpy as np

from benchmarks.ratios import judged, seconds
from diagnosis.baselines.sysid import fitted
from diagnosis.baselines.sysid_models import FreeParameter, free_parameters
from diagnosis.effects import PlacedEffect, effect
from diagnosis.plant.plant import Plant
from diagnosis.residuals.channels import shared_channels
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.search.fitting import fit_all
from diagnosis.traces.read import read_traces
from diagnosis.traces.trace import Trace
from experiments.record import Record
from experiments.record import main as record

JOINTS = ("LKneePitch", "LHipRoll", "LAnklePitch", "LShoulderRoll",
          "RKneePitch", "RHipRoll", "RAnklePitch", "RShoulderRoll")  # fmt: skip
EFFECTS = ("viscous_friction", "coulomb_friction")
HIDDEN_VALUE = 0.2
"""Viscous friction [N m s/rad] that the recorded joint has and the model lacks."""

HIDDEN = (f"viscous_friction@LKneePitch:coefficient={HIDDEN_VALUE}",)
DURATION_S, ROUNDS = 4.0, 3
MOST = 1.0
"""Largest ratio of times, diagnosis to mujoco.sysid, that passes the benchmark."""

ALIKE = 0.5
"""Largest relative error of a fitted friction that counts as found. It is large because
mujoco.sysid's models keep the error of the integrator."""


def measure() -> list[float]:
    """Time of the diagnosis divided by that of mujoco.sysid, per fit, in each round."""
    plant, traces = _recording()
    predictor = Predictor(plant, traces, shared_channels(plant, traces), threads=1)
    predictor.calibrate()
    models = [_model(plant, joint) for joint in JOINTS]
    free = free_parameters(plant, traces)
    _check_found(predictor, models[0], _of(free, JOINTS[0]))
    ratios = []
    for number in range(ROUNDS):
        ours_s = seconds(partial(fit_all, predictor, models)) / len(models)
        joint = JOINTS[number % len(JOINTS)]
        theirs_s = seconds(partial(fitted, plant, traces, _of(free, joint)))
        ratios.append(ours_s / theirs_s)
    return ratios


def report(ratios: list[float]) -> tuple[str, bool]:
    """Text that reports the ratios of times, and whether their median passes."""
    line, passes = judged("time against mujoco.sysid's fit", ratios, "at most", MOST)
    return (
        f"fit of a candidate, {len(EFFECTS)} parameters, {DURATION_S:g} s of the NAO, "
        f"{len(JOINTS)} side by side\n{line}"
    ), passes


def _recording() -> tuple[Plant, list[Trace]]:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "air.parquet")
        with contextlib.redirect_stdout(io.StringIO()):
            record(Record(path, world="sim", hidden=HIDDEN, duration=DURATION_S))
        return read_traces([path], "nao")


def _model(plant: Plant, joint: str) -> Model:
    return tuple(
        PlacedEffect(
            name,
            joint,
            tuple(one.typical for one in effect(name).parameters(plant, joint)),
        )
        for name in EFFECTS
    )


def _of(free: list[FreeParameter], joint: str) -> list[FreeParameter]:
    return [
        one for one in free if one.placed.key in {f"{name}@{joint}" for name in EFFECTS}
    ]


def _check_found(predictor: Predictor, model: Model, free: list[FreeParameter]) -> None:
    """Check that both programs find the hidden viscous friction."""
    fit = fit_all(predictor, [model])[0]
    ours = next(p.values[0] for p in fit.model if p.name == EFFECTS[0])
    counts, _ = fitted(predictor.plant, predictor.traces, free)
    pairs = zip(free, counts, strict=True)
    theirs = next(
        one.value(count) for one, count in pairs if one.placed.name == EFFECTS[0]
    )
    np.testing.assert_allclose([ours, theirs], HIDDEN_VALUE, rtol=ALIKE)
