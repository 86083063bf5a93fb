"""Made-up verdicts of each kind, with held-out series that match them."""

import numpy as np

from diagnosis.conclude.held_out_series import ChannelSeries, HeldOutSeries
from diagnosis.verdict import (
    Amount,
    ChannelFit,
    Estimate,
    Fit,
    Found,
    MismatchCell,
    NextExperiment,
    PlacedEffect,
    Recordings,
    Unexplained,
    Verdict,
    When,
)
from experiments.diagnosis_report.page import ReportFacts

JOINTS = (
    "LHipYawPitch", "LHipRoll", "LHipPitch", "LKneePitch", "LAnklePitch", "LAnkleRoll",
    "RHipRoll", "RHipPitch", "RKneePitch", "RAnklePitch", "RAnkleRoll",
    "LShoulderPitch", "LShoulderRoll", "RShoulderPitch", "RShoulderRoll",
)  # fmt: skip
NOISE_RAD = 0.0009
WORST = "position.LKneePitch"

FACTS = ReportFacts(
    robot="nao",
    base="fixed",
    command="groundwalk diagnose recordings/*.parquet --robot nao --out runs/diagnosis",
    settings={"step": "0.5 ms (halving it changes 0.04 mrad)", "seed": "7"},
    versions={"groundwalk": "0.1.0", "commit": "0123abc", "MuJoCo": "4.0.0"},
    files={
        "diagnosis.json": "all of this as numbers",
        "overlay.rrd": "all of it over time, in Rerun",
        "corrected.xml": "the corrected model",
    },
)
RECORDINGS = Recordings(
    fit=("air_multisine_0", "air_chirp_0"),
    select=("air_ramps_0",),
    test=("air_multisine_1", "air_steps_1"),
)
PLAY = Found(
    "backlash",
    "LKneePitch",
    {"gap": Estimate(0.0304, 0.0271, 0.0338, "rad")},
    probability=0.97,
    confusable_with=(PlacedEffect("coulomb_friction", "LKneePitch"),),
    native=False,
)
LATENCY = Found(
    "command_latency",
    "commands",
    {"delay": Estimate(0.0183, 0.0175, 0.0190, "s")},
    probability=0.998,
    native=False,
)
PUSH = Found(
    "external_force",
    "torso",
    {
        "x": Estimate(3.1, 2.2, 4.1, "N"),
        "y": Estimate(-0.2, -0.9, 0.4, "N"),
        "z": Estimate(0.0, -0.5, 0.6, "N"),
        "start": Estimate(12.31, 12.28, 12.34, "s"),
        "duration": Estimate(0.25, 0.2, 0.31, "s"),
    },
    probability=0.88,
    when=When("burst", 12.31, 12.56),
)
SLOW_RAMPS = NextExperiment(
    "slow ramps with reversals",
    "LKneePitch",
    "play opens a gap as wide at all speeds, dry friction only with a soft servo",
)


def mismatch(excess=5.0):
    cells = []
    for rank, joint in enumerate(("LKneePitch", "LAnklePitch", "LHipPitch", *JOINTS)):
        if joint in ("LKneePitch", "LAnklePitch", "LHipPitch") and rank > 2:
            continue
        times = max(1.03, excess * 0.45**rank)
        cells.append(
            MismatchCell(
                f"position.{joint}",
                "rad",
                share=(0.78, 0.14, 0.05)[rank] if rank < 3 else 0.03 / 12,
                error_rms=times * NOISE_RAD,
                noise_rms=NOISE_RAD,
                regimes={
                    "forward": times,
                    "backward": 1.05 * times,
                    "reversals": 2.1 * times,
                    "slow": 1.3 * times,
                    "fast": 0.8 * times,
                    "high load": 0.9 * times,
                },
                bursts=((3.1, 3.6), (12.3, 12.6)) if rank < 2 else (),
            )
        )
    return tuple(cells)


def fit(excess=5.7, corrected=1.3):
    channels = {}
    for rank, joint in enumerate(("LKneePitch", *JOINTS[:3], *JOINTS[4:])):
        nominal = NOISE_RAD * max(1.02, excess * 0.5**rank)
        after = NOISE_RAD * max(1.01, corrected * 0.9**rank)
        channels[f"position.{joint}"] = ChannelFit(
            nominal=nominal,
            corrected=min(after, nominal),
            floor=NOISE_RAD,
            ceiling=0.95 * min(after, nominal),
            wrong_place=0.97 * nominal,
            wrong_effect=0.85 * nominal,
            unit="rad",
        )
    return Fit(
        nominal=excess,
        corrected=corrected,
        floor=1.0,
        ceiling=1.22,
        wrong_place=0.97 * excess,
        wrong_effect=0.8 * excess,
        channels=channels,
    )


EFFECTS = Verdict(
    "effects",
    effects=(PLAY, LATENCY),
    alternatives=(
        (
            PlacedEffect("coulomb_friction", "LKneePitch"),
            PlacedEffect("command_latency", "commands"),
        ),
    ),
    limits=(
        "Recorded at 100 Hz: rotor inertia below 0.002 kg m² cannot be told from none.",
        "RElbowYaw hardly moved: nothing is said about it.",
    ),
    mismatch=mismatch(),
    fit=fit(),
    next_experiment=SLOW_RAMPS,
    recordings=RECORDINGS,
    seconds=41.3,
)
ONE = Verdict("effects", effects=(PLAY,), mismatch=mismatch(), fit=fit())
NONE = Verdict(
    "none",
    smallest_detectable={
        "backlash@LKneePitch": Amount(0.0042, "rad"),
        "coulomb_friction@LKneePitch": Amount(0.018, "N m"),
        "command_latency@commands": Amount(0.0006, "s"),
    },
    mismatch=mismatch(1.1),
    fit=fit(1.06, 1.06),
    recordings=RECORDINGS,
    seconds=38.0,
)
UNKNOWN = Verdict(
    "unknown",
    effects=(LATENCY,),
    unexplained=Unexplained(
        share=0.41,
        channel=WORST,
        unit="rad",
        against=WORST,
        against_unit="rad",
        at=tuple(np.linspace(0.1, 1.9, 40)),
        mean=tuple(0.003 * np.sin(14 * np.linspace(0.1, 1.9, 40))),
        spread=(0.0003,) * 40,
    ),
    mismatch=mismatch(),
    fit=fit(corrected=3.6),
    next_experiment=NextExperiment(
        "slow ramps over the whole range", "LKneePitch", "the shape shows up at once"
    ),
    recordings=RECORDINGS,
    seconds=55.0,
)
OPEN = Verdict(
    "not_identifiable",
    alternatives=(
        (PlacedEffect("payload_mass", "LTibia"),),
        (PlacedEffect("servo_gain", "LKneePitch"),),
        (
            PlacedEffect("ground_slope", "world"),
            PlacedEffect("encoder_offset", "LHipPitch"),
        ),
    ),
    limits=("The robot stood still: masses, tilt and servo stiffness act alike.",),
    mismatch=mismatch(2.0),
    fit=fit(2.0, 2.0),
    next_experiment=NextExperiment(
        "static holds at mirrored poses", None, "a mass pulls down on both sides"
    ),
    recordings=RECORDINGS,
    seconds=12.0,
)
KINDS = {"effects": EFFECTS, "none": NONE, "unknown": UNKNOWN, "not_identifiable": OPEN}


def series(name="air_multisine_1", duration_s=20.0, seed=3, joints=JOINTS):
    """Held-out positions; only the left knee differs from the sim, by backlash."""
    random = np.random.default_rng(seed)
    time_s = np.arange(0.0, duration_s, 0.01)
    channels = {}
    for index, joint in enumerate(joints):
        motion = 0.4 * np.sin((1.3 + 0.11 * index) * time_s) + 0.2 * np.sin(
            (3.1 - 0.09 * index) * time_s + index
        )
        noise = NOISE_RAD * random.standard_normal(time_s.size)
        off = 0.012 * np.tanh(4 * np.gradient(motion, time_s)) * (joint == "LKneePitch")
        real = motion - off + noise
        channels[f"position.{joint}"] = ChannelSeries(real, motion, motion - 0.93 * off)
    return HeldOutSeries(name, time_s, channels)
