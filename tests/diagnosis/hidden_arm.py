"""Recordings of an arm in the hidden world, as a diagnosis reads them.

Effects there are written apart from those of the diagnosis, and act in an engine that
is stepped otherwise: what one finds on the other's recordings is not its own doing.
"""

from dataclasses import replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from diagnosis.effects.parts import PlacedEffect
from diagnosis.plant.load import load_plant
from diagnosis.plant.servo import Servo
from diagnosis.residuals.channels import Channels
from diagnosis.residuals.predictor import Predictor
from diagnosis.search.fitting import fit_all
from diagnosis.traces.trace import Trace
from worlds.hidden.effects import Hidden
from worlds.hidden.limbs import limb_plant
from worlds.hidden.run import Clock, run_hidden

STEP_S, TICK_S, NOISE_RAD = 5e-4, 0.01, 2e-4
JOINTS = "J1", "J2"
ROUNDS = 2


def commanded(time_s, seed, size=0.25, slowest=1.5, fastest=7.0):
    """(T, 2) sums of sines that begin at rest."""
    random = np.random.default_rng(seed)
    phases = random.uniform(0, 6, (2, 3, 1))
    rates = random.uniform(slowest, fastest, (2, 3, 1))
    rise = 1 - np.exp(-((time_s / 0.3) ** 2))
    return (rise * size * np.sin(rates * time_s + phases).sum(axis=1)).T


@cache
def hidden_plant():
    return limb_plant("two_dof")


@cache
def plant():
    """The nominal arm as the diagnosis loads it."""
    nominal = hidden_plant()
    name, text = nominal.file
    with TemporaryDirectory() as folder:
        source = Path(folder) / name
        source.write_text(text)
        loaded = load_plant(source, "fixed", nominal.joints)
    return replace(loaded, servo=servo_of(nominal))


def servo_of(nominal):
    return Servo(
        nominal.kp_nm_rad,
        nominal.kd_nm_s_rad,
        nominal.max_torque_nm,
        nominal.back_emf_nm_s_rad,
    )


@cache
def recorded(*effects, seed=0, duration_s=2.5, late_rows=(0, 0), **motion):
    """A trace of the arm with hidden effects, which are given as texts.

    The command of each joint gets to its servo some rows late.
    """
    nominal = hidden_plant()
    time_s = np.arange(round(duration_s / TICK_S) + 1) * TICK_S
    commands = commanded(time_s, seed, **motion)
    rows = np.maximum(np.arange(len(time_s))[:, None] - late_rows, 0)
    sent = commands[rows, [0, 1]]
    ticks = np.arange(len(time_s)) * round(TICK_S / STEP_S)
    run = run_hidden(
        nominal,
        [Hidden.parse(text) for text in effects],
        "mujoco",
        Clock(STEP_S, ticks, 0),
        lambda row, sense: sent[row],
        commands[0],
        np.random.SeedSequence(0),
    )
    noise = np.random.default_rng(seed + 1000).standard_normal(commands.shape)
    position = run.encoder_rad + NOISE_RAD * noise
    servo = servo_of(nominal)
    return Trace(f"arm {seed}", time_s, position, servo, command_rad=commands)


def predictor_of(*traces):
    """A predictor of traces of the arm that knows their noise."""
    names = tuple(f"position.{joint}" for joint in JOINTS)
    return Predictor(plant(), traces, Channels(names, np.full(2, NOISE_RAD)))


def model_of(*effects):
    return tuple(
        PlacedEffect(name, place, tuple(values)) for name, place, *values in effects
    )


def fitted(predictor, *effects):
    """The fit of effects (name, place, *values), corrected where it leads to."""
    model = model_of(*effects)
    for _ in range(ROUNDS):
        predictor.calibrate(model, tolerances=False)
        (fit,) = fit_all(predictor, [model])
        model = fit.model
    return fit


def floor(predictor):
    """Half the sum of squares [nats] of what noise alone leaves, and its spread."""
    rows = int(predictor.scored.sum())
    return rows / 2, np.sqrt(rows / 2)


def errors(fit):
    """(p,) standard errors of a fit's values, in scaled coordinates."""
    return np.sqrt(np.diag(np.linalg.inv(fit.jacobian.T @ fit.jacobian)))
