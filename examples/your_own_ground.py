"""Walk on ground of your own: an array of heights, or a picture whose grey is height.

python examples/your_own_ground.py --image path/to/heights.png
"""

from pathlib import Path

import matplotlib.image
import numpy as np
import tyro

import robots
import worlds
from experiments.trials import TrialRules, Trials, walk_trials
from terrain import Heightfield, configuration
from walk_engine import gaits


def main(
    image: Path | None = None, height_m: float = 0.01, limit_s: float = 10.0
) -> Trials:
    """Walk from the middle of the left edge to the right, in the real world.

    Args:
      image: a PNG; small waves where there is none.
      height_m: of white over black.
      limit_s: time limit.
    """
    if image is None:
        grey = 0.5 + 0.5 * np.sin(np.arange(240) / 5) * np.ones((120, 1))
    else:
        picture = matplotlib.image.imread(image)[::-1]  # rows run along +y
        grey = picture if picture.ndim == 2 else picture[..., :3].mean(axis=2)
    spacing_m, x_m, y_m = 0.025, -1.0, -0.025 * len(grey) / 2
    x, y = np.meshgrid(*(np.arange(n) * spacing_m for n in grey.shape[::-1]))
    flat_start = configuration("flat").past_start(np.hypot(x + x_m, y + y_m))
    ground = Heightfield(height_m * grey * flat_start, (x_m, y_m), spacing_m)
    world = worlds.make(
        "real", robots.get("nao"), [ground], [np.random.SeedSequence(1)]
    )
    trials = walk_trials(world, [gaits.get("start")], TrialRules(limit_s))
    world.close()
    print(f"{trials.speed_cm_s[0]:.1f} cm/s, {trials.ended[0] or 'still walking'}")
    return trials


if __name__ == "__main__":
    tyro.cli(main)
