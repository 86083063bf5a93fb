"""Models that learn what an action does, and which action has a wanted effect.

Forward models predict next states, inverse models actions. The names in `__all__` need
PyTorch, so their modules are imported when they are first used.
"""

from typing import TYPE_CHECKING

from groundwalk.faces import lazy_face

if TYPE_CHECKING:
    from sgat.models.distributional_inverse import DistributionalInverse
    from sgat.models.forward_config import ForwardConfig
    from sgat.models.forward_model import ForwardModel
    from sgat.models.inverse_model import InverseModel
    from sgat.models.network_config import NetworkConfig

__all__ = [
    "DistributionalInverse",
    "ForwardConfig",
    "ForwardModel",
    "InverseModel",
    "NetworkConfig",
]

__getattr__ = lazy_face(
    __name__,
    {
        "distributional_inverse": ["DistributionalInverse"],
        "forward_config": ["ForwardConfig"],
        "forward_model": ["ForwardModel"],
        "inverse_model": ["InverseModel"],
        "network_config": ["NetworkConfig"],
    },
)
