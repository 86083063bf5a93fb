"""Tune a gait in the sim, and see at once how it walks in both worlds.

python examples/tune_a_gait.py --population 150 --generations 15
"""

from pathlib import Path

import tyro

from experiments.optimize_gait import OptimizeGait, tune_gait
from walk_engine import Gait


def main(
    out: Path, population: int = 24, generations: int = 5, trials: int = 3
) -> Gait:
    """Tune; everything else is in the run's folder, report.html first.

    Args:
      out: the run's folder, a new one.
      population: gaits tried in each generation.
      generations: how many there are.
      trials: of the start gait and the tuned one, in each world.
    """
    config = OptimizeGait(
        population=population, generations=generations, trials=trials, out=out
    )
    folder, gait = tune_gait(config)
    print(f"open {folder.path / 'report.html'}; the gait: {dict(gait)}")
    return gait


if __name__ == "__main__":
    tyro.cli(main)
