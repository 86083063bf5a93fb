"""Walk with a robot of your own: a URDF, or a TOML file such as robots/nao.toml.

python examples/your_own_robot.py --robot path/to/robot.urdf
"""

import tempfile
from pathlib import Path

import numpy as np

import robots
import terrain
import worlds
from experiments import run_script
from experiments.walking import TrialRules, Trials, walk_trials
from walk_engine import gaits


def main(robot: Path | None = None, limit_s: float = 7.5) -> Trials:
    """Walk straight ahead on flat ground in the sim (MuJoCo).

    Args:
      robot: the robot's file; without one, a NAO whose torso has twice the mass.
      limit_s: time limit [s].
    """
    if robot is None:
        nao = Path(robots.__file__).with_name("nao.toml").read_text()
        robot = Path(tempfile.mkdtemp(), "heavy.toml")
        robot.write_text(nao.replace("mass = 1.04956", "mass = 2.09912"))
    description = robots.get(str(robot))
    ground, seed = terrain.make("flat", seed=0), np.random.SeedSequence(1)
    world = worlds.make("sim", description, [ground], [seed])
    trials = walk_trials(world, [gaits.get("start")], TrialRules(limit_s))
    speed_cm_s, end = trials.speed_cm_s[0], trials.ended[0] or "still walking"
    print(f"{description.mass_kg:.2f} kg, {speed_cm_s:.1f} cm/s, {end}")
    return trials


if __name__ == "__main__":
    run_script(main)
