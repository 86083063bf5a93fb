"""A servo on a bench that swings a known mass on a lever, in the hidden world.

The motor is a DC motor with a voltage; a test hides friction of its gear.
"""

from dataclasses import replace

import numpy as np

from diagnosis.plant.load import load_plant
from diagnosis.plant.servo import Servo
from diagnosis.traces.read import trace_of
from worlds.hidden.effects import Hidden
from worlds.hidden.plant import hinged_plant
from worlds.hidden.recorded import HiddenSensors, hidden_recording
from worlds.hidden.run import Clock, run_hidden
from worlds.recordings.load import Load
from worlds.recordings.metadata import RecordingMetadata

JOINT = "servo"
TORQUE_PER_A, OHM, SUPPLY_V, DUTY_1_RAD = 2.21, 2.03, 12.0, 5.0
"""Torque constant [N m/A], resistance, supply, and duty for each radian of error of a
motor as strong as the MX-106 of the published parameters."""
ROTOR_KG_M2 = 0.026
STALL_NM = TORQUE_PER_A * SUPPLY_V / OHM
KP, EMF = DUTY_1_RAD * STALL_NM, TORQUE_PER_A**2 / OHM
"""What the voltage law is as a servo: kt / R clip(duty e) V - kt^2 / R w."""
STEP_S, TICK_S, NOISE_RAD = 0.0005, 0.01, 3e-4


def xml(load=None):
    """MJCF of a light lever behind the rotor, and of a load that it carries."""
    carried = ""
    if load is not None:
        place = " ".join(map(str, load.at))
        carried = f"""<body pos="{place}">
          <inertial pos="0 0 0" mass="{load.mass}" diaginertia="0 0 0"/></body>"""
    return f"""<mujoco model="bench"><compiler angle="radian"/><worldbody>
      <body name="lever"><joint name="{JOINT}" axis="0 1 0" range="-3 3"
        armature="{ROTOR_KG_M2}"/>
      <inertial pos="0 0 -.05" mass=".1" diaginertia=".001 .001 .001"/>
      {carried}</body></worldbody></mujoco>"""


def command(time_s, seed):
    """(rows, 1) targets: slow turns, faster swings and steps, different by seed."""
    rng = np.random.default_rng(seed)
    rise = np.minimum(time_s, 1.0)
    turn = rng.uniform(0.15, 0.3)
    slow = rng.uniform(0.9, 1.4) * np.sin(2 * np.pi * turn * time_s)
    fast = rng.uniform(0.05, 0.1) * np.sin(2 * np.pi * rng.uniform(0.7, 1.5) * time_s)
    hop = 0.08 * np.sign(np.sin(2 * np.pi * rng.uniform(0.2, 0.35) * time_s))
    hop[time_s < 0.6 * time_s[-1]] = 0.0
    return (rise * (slow + fast) + hop)[:, None]


def load(mass_kg, lever_m):
    """A known mass on the lever."""
    return Load(mass_kg, (0.0, 0.0, -lever_m))


def hidden_bench(carried):
    """The bench as the hidden world has it, with its load and without friction."""
    servo = np.array([KP, 0.0, STALL_NM, 5.0])
    bare = hinged_plant("bench", "bench.xml", xml(carried), servo)
    return replace(bare, back_emf_nm_s_rad=np.array([EMF]))


def recorded(effects, plant, carried, seed, duration_s=12.0, engine="mujoco"):
    """A trace of the bench with a load and hidden effects, given as texts."""
    hidden = [Hidden.parse(text) for text in effects]
    rows = round(duration_s / TICK_S) + 1
    targets = command(np.arange(rows) * TICK_S, seed)
    clock = Clock(STEP_S, np.arange(rows) * round(TICK_S / STEP_S), 0)
    nobody = np.random.SeedSequence(seed)
    bench = hidden_bench(carried)
    run = run_hidden(
        bench,
        hidden,
        engine,
        clock,
        lambda row, sense: targets[row],
        targets[0],
        nobody,
    )
    assert run.ok
    sensors = HiddenSensors(encoder_rad=NOISE_RAD)
    metadata = RecordingMetadata(
        "bench.xml", "fixed", "test", bench.servo, {"lever": carried}
    )
    rng = np.random.default_rng(seed + 1)
    recording = hidden_recording(bench, run, hidden, sensors, rng, metadata)
    return trace_of(recording, plant, f"bench_{seed}")


def nominal(tmp_path, *loads):
    """The model of the bench, which has no friction, for recordings with these loads.

    Its back-EMF is outside of the torque limit.
    """
    path = tmp_path / "bench.xml"
    path.write_text(xml())
    plant = load_plant(path, "fixed", (JOINT,)).bearing(
        [{"lever": one} for one in loads]
    )
    spec, servo = plant.spec.copy(), (KP, 0.0, STALL_NM, EMF)
    joint = spec.joint(JOINT)
    joint.damping = [joint.damping[0] + EMF, *joint.damping[1:]]
    motor = Servo(*(np.array([value]) for value in servo))
    return replace(plant, spec=spec, servo=motor)
