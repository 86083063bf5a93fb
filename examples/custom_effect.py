"""An effect of your own, which the diagnosis looks for beside the built-in effects.

    python examples/custom_effect.py --folder runs/water

A pendulum swings in water, whose drag grows with the square of the speed. None of the
built-in effects does; the class `WaterDrag` describes it.
"""

from pathlib import Path

import mujoco
import numpy as np

from diagnosis import (
    Effect,
    Parameter,
    Verdict,
    also_known,
    diagnose,
    read_traces,
)
from experiments import print_verdict, run_script
from worlds import Recording, RecordingMetadata, ServoGains, write_recording

PENDULUM = """<mujoco><option timestep="0.001"/><worldbody><body name="rod">
<joint name="swing" axis="0 1 0" damping="0 {water}"/>
<geom type="capsule" fromto="0 0 0 0 0 -0.5" size="0.02" mass="1"/></body></worldbody>
<actuator><position joint="swing" kp="20" kv="0.5"/></actuator></mujoco>"""


class WaterDrag(Effect):
    """Drag of water on a joint of speed v [rad/s]: a torque -c v|v| [N m]."""

    name, place_kind, native = "water_drag", "joint", True

    def places(self, plant, traces):
        """Places where the effect may be: every joint of the robot."""
        return plant.joints

    def parameters(self, plant, place):
        """The coefficient c of the drag: unit, bounds, no-drag value, first guess."""
        return (Parameter("coefficient", "N m s^2/rad^2", 0.0, 5.0, 0.0, 0.1),)

    def apply(self, copies, row, place, values):
        """Add the drag to a row of the batch: MuJoCo's second damping coefficient."""
        copies.field("dof_dampingpoly")[row, copies.dof(place), 0] += values[0]


def swing(path: Path, duration: float, seed: int) -> None:
    """Record a pendulum in water that follows random commands for `duration` [s]."""
    model = mujoco.MjModel.from_xml_string(PENDULUM.format(water=0.3))
    data, rng, rows = mujoco.MjData(model), np.random.default_rng(seed), []
    pace = rng.uniform(3, 9, 3)
    for time_s in np.arange(0, duration, 0.01):
        data.ctrl[0] = 0.5 * np.sin(pace * time_s).sum()
        measured = data.qpos[0] + 1e-4 * rng.standard_normal()
        rows.append((time_s, measured, data.ctrl[0]))
        mujoco.mj_step(model, data, 10)
    names = ("time", "position.swing", "command.swing")
    servo = {"swing": ServoGains(kp=20, kd=0.5, max_torque=100)}
    metadata = RecordingMetadata("pendulum.xml", "fixed", "in water", servo)
    columns = dict(zip(names, np.array(rows).T, strict=True))
    write_recording(Recording(columns, metadata), path)


def main(folder: Path, duration: float = 6.0) -> Verdict:
    """Make two recordings in water, and diagnose them with a model without water.

    Args:
      folder: folder for the model and the recordings.
      duration: length of a recording [s].
    """
    paths = [folder / f"swing{seed}.parquet" for seed in (1, 2)]
    for seed, path in enumerate(paths):
        swing(path, duration, seed)
    (folder / "pendulum.xml").write_text(PENDULUM.format(water=0))
    plant, traces = read_traces(paths, folder / "pendulum.xml")
    with also_known(WaterDrag()):
        verdict = diagnose(plant, traces, np.random.SeedSequence(1)).verdict
        print_verdict(verdict, [])
    return verdict


if __name__ == "__main__":
    run_script(main)
