"""Walk on ground of your own: an array of heights, or a picture whose grey is height.

python examples/your_own_ground.py --image path/to/heights.png
"""

from pathlib import Path

import matplotlib.image
import numpy as np

import robots
import worlds
from experiments import run_script
from experiments.walking import TrialRules, Trials, walk_trials
from terrain import Heightfield
from walk_engine import gaits


def main(
    image: Path | None = None, height_m: float = 0.01, limit_s: float = 10.0
) -> Trials:
    """Walk in the real world (PyBullet) from the picture's left edge to the right.

    Args:
      image: a PNG file; without one, the ground has small waves.
      height_m: height of white above black [m].
      limit_s: time limit [s].
    """
    if image is None:
        grey = np.tile(0.5 + 0.5 * np.sin(np.arange(240) / 5), (120, 1))
    else:  # rows run along +y, from the picture's bottom to its top
        grey = np.atleast_3d(matplotlib.image.imread(image))[::-1, :, :3].mean(axis=2)
    x_m = 0.025 * np.arange(grey.shape[1]) - 1.0
    heights_m = height_m * grey * (2 * x_m - 0.5).clip(0, 1)  # it starts on the flat
    ground = Heightfield(heights_m, (x_m[0], -0.0125 * len(grey)), spacing_m=0.025)
    seed = np.random.SeedSequence(1)
    world = worlds.make("real", robots.get("nao"), [ground], [seed])
    trials = walk_trials(world, [gaits.get("start")], TrialRules(limit_s))
    world.close()
    print(f"{trials.speed_cm_s[0]:.1f} cm/s, {trials.ended[0] or 'still walking'}")
    return trials


if __name__ == "__main__":
    run_script(main)
