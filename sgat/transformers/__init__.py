"""Action transformers, which change a sim's actions, and the groundings that make them.

A grounding is a method, such as SGAT, that learns a transformer from data; a new one is
one file in this folder. See `sgat.transformers.catalogue`.
"""

from sgat.transformers.action_noise import ActionNoise
from sgat.transformers.block_noise import BlockNoise
from sgat.transformers.catalogue import (
    add_grounding,
    file_kind,
    grounding,
    groundings,
)
from sgat.transformers.transformer import KeptTransformer, Transformer
from sgat.transformers.transformer_files import read_transformer, write_transformer

__all__ = [
    "ActionNoise",
    "BlockNoise",
    "KeptTransformer",
    "Transformer",
    "add_grounding",
    "file_kind",
    "grounding",
    "groundings",
    "read_transformer",
    "write_transformer",
]
