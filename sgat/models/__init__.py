"""What models learn from transitions: what actions do, and which action does a thing.

The names of this face need PyTorch, so they are imported when they are first used.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

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

_HOMES = {
    "DistributionalInverse": "distributional_inverse",
    "ForwardConfig": "forward_config",
    "ForwardModel": "forward_model",
    "InverseModel": "inverse_model",
    "NetworkConfig": "network_config",
}


def __getattr__(name: str) -> Any:
    """Import a name of this face when it is first used."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
