"""How large the nominal robot's own torques, speeds and masses are in a motion."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from groundwalk.arrays import FloatArray
from worlds.hidden.bodies import Bodies, bodies
from worlds.hidden.engine import least_inertia_kg_m2
from worlds.hidden.plant import HiddenPlant
from worlds.hidden.run import Run

_MOSTLY = 95


@dataclass(frozen=True, eq=False)
class Scales:
    """Arrays (j,) over joints; what hidden sizes are parts of.

    Attributes:
      torque_nm: that the servos mostly stay below.
      peak_nm: most torque.
      peak_rad_s: highest speed of a command.
      reach_rad: (j, 2) lowest and highest position.
      asked_rad: how far apart its commands are.
      inertia_kg_m2: what a joint moves.
      carried_kg: mass of all that hangs on a joint.
      axis: (j, 3) in the frame of that body.
      moving_kg: all that moves.
      bodies: how far they move, and their weights' levers.
    """

    torque_nm: FloatArray
    peak_nm: FloatArray
    peak_rad_s: FloatArray
    reach_rad: FloatArray
    asked_rad: FloatArray
    inertia_kg_m2: FloatArray
    carried_kg: FloatArray
    axis: FloatArray
    moving_kg: float
    bodies: Bodies


def scales(plant: HiddenPlant, runs: Sequence[Run]) -> Scales:
    """Measured on runs of the nominal robot; the largest of them counts.

    Args:
      plant: the robot.
      runs: with nothing hidden.
    """
    torque = [_servo_nm(plant, run) for run in runs]
    asked = [
        np.abs(np.diff(run.command_rad, axis=0)) / np.diff(run.clock.time_s)[:, None]
        for run in runs
    ]
    places = np.concatenate([run.position_rad for run in runs])
    commands = np.concatenate([run.command_rad for run in runs])
    model = plant.make_spec().compile()
    joints = [model.joint(name) for name in plant.joints]
    base_kg = 0.0
    if plant.description is not None and plant.floating:
        base_kg = plant.description.root.inertial.mass_kg
    masses = [float(model.body(name).mass[0]) for name in plant.links]
    carried = [float(model.body(name).subtreemass[0]) for name in plant.links]
    return Scales(
        torque_nm=np.max([np.percentile(t, _MOSTLY, axis=0) for t in torque], axis=0),
        peak_nm=np.concatenate(torque).max(axis=0),
        peak_rad_s=np.concatenate(asked).max(axis=0),
        reach_rad=np.stack([places.min(axis=0), places.max(axis=0)], axis=1),
        asked_rad=np.ptp(commands, axis=0),
        inertia_kg_m2=least_inertia_kg_m2(plant, [runs[0].position_rad[0]]),
        carried_kg=np.array(carried),
        axis=np.array([model.jnt_axis[joint.id] for joint in joints]),
        moving_kg=float(sum(masses)) + base_kg,
        bodies=bodies(plant, runs),
    )


def _servo_nm(plant: HiddenPlant, run: Run) -> FloatArray:
    """(rows, j) sizes of the servos' torques."""
    speed = np.gradient(run.position_rad, run.clock.time_s, axis=0)
    error = run.command_rad - run.position_rad
    wanted = plant.kp_nm_rad * error - plant.kd_nm_s_rad * speed
    held = np.clip(wanted, -plant.max_torque_nm, plant.max_torque_nm)
    return np.asarray(np.abs(held - plant.back_emf_nm_s_rad * speed))
