"""Action transformers, which change a sim's actions, and the groundings that make them.

A grounding is a method, such as SGAT, that learns a transformer from data; a new one is
one file in this folder. See `sgat.transformers.catalogue`.
"""

from sgat.transformers.catalogue import (
    grounding,
    groundings,
    read_transformer,
    write_transformer,
)

__all__ = ["grounding", "groundings", "read_transformer", "write_transformer"]
