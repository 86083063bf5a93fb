"""The NAO's walks in sims that are grounded on real walks, and ratings of gaits there.

The folder belongs to `experiments` and not to `sgat`, because it combines packages:
trials of gaits, grounding, and sims that a diagnosis has corrected.
"""

from experiments.grounded_walks.courses import noisy_sim
from experiments.grounded_walks.models import GroundingStep

__all__ = ["GroundingStep", "noisy_sim"]
