"""Grounding: makes a simulator behave like the real world, by changing its actions.

GAT (Hanna and Stone 2017), SGAT (Desai et al. 2020) and variants of them. Models learn
from real transitions what an action does in the real world; each action is then
replaced by the one that has the same effect in the simulator. The shelves:

- `sgat.models`: forward and inverse models, small networks.
- `sgat.transformers`: action transformers, and the groundings that make them.
- `sgat.walks`: worlds in which robots walk, grounded.
- `sgat.gym`: Gymnasium environments, grounded.
- `sgat.tabular`: finite worlds, where every model is a table; needs NumPy only.

PyTorch is imported by the modules of `models` and by nothing before them.
"""

from sgat.noise import NoiseLaw, NoiseStream, WhiteNoise
from sgat.transitions import Transitions

__all__ = ["NoiseLaw", "NoiseStream", "Transitions", "WhiteNoise"]
