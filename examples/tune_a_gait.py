"""Tune a gait in the sim (MuJoCo), then try it there and in PyBullet.

python examples/tune_a_gait.py --out runs/tuned --population 150 --generations 15
"""

from pathlib import Path

from experiments import OptimizeGait, run_script, tune_gait
from walk_engine import Gait


def main(
    out: Path, population: int = 24, generations: int = 5, trials: int = 3
) -> Gait:
    """Tune a gait. The results are in the folder `out`: open report.html first.

    Args:
      out: new folder for the results.
      population: gaits tried in each generation.
      generations: number of generations.
      trials: trials of the start gait and of the tuned one, in each world.
    """
    config = OptimizeGait(
        population=population, generations=generations, trials=trials, out=out
    )
    folder, gait = tune_gait(config)
    print(f"open {folder.path / 'report.html'}; the gait: {dict(gait)}")
    return gait


if __name__ == "__main__":
    run_script(main)
