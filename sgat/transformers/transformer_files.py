"""Action transformers in folders: their models, and what is between them."""

import json
from pathlib import Path
from typing import Any

import numpy as np

from groundwalk.errors import BadModelError, BadValueError
from groundwalk.files import write_text
from sgat.models.distributional_inverse import DistributionalInverse
from sgat.models.forward_model import ForwardModel
from sgat.models.inverse_model import InverseModel
from sgat.noise import WhiteNoise
from sgat.transformers.action_transformer import ActionTransformer
from sgat.transformers.direct_transformer import DirectTransformer

HEADER, DIRECT = "transformer.json", "direct.pt"
FORWARD, INVERSE = "forward.pt", "inverse.pt"
_FORMAT = 1


def write_transformer(
    folder: Path, transformer: ActionTransformer | DirectTransformer
) -> None:
    """Write a transformer into a folder, which is made if it is not there.

    Args:
      folder: gets a header and a file for each model.
      transformer: whose noise, if it has any, is white; other laws hold data.

    Raises:
      BadValueError: it is no such transformer.
    """
    low, high = (bound.tolist() for bound in transformer.bounds)
    header: dict[str, Any] = {"format": _FORMAT, "low": low, "high": high}
    if isinstance(transformer, DirectTransformer):
        transformer.save(folder / DIRECT)
        header["kind"] = "direct"
    else:
        noise = transformer.noise
        if not (noise is None or isinstance(noise, WhiteNoise)):
            kind = type(noise).__name__
            raise BadValueError(f"the noise is {kind}; only white noise can be written")
        transformer.forward.save(folder / FORWARD)
        transformer.inverse.save(folder / INVERSE)
        header |= {
            "kind": "through models",
            "distributional": isinstance(transformer.inverse, DistributionalInverse),
            "noise_dimensions": noise and noise.dimensions,
            "smoothing": transformer.smoothing,
            "inverse_columns": transformer.inverse_columns,
        }
    write_text(folder / HEADER, json.dumps(header, indent=1) + "\n")


def read_transformer(folder: Path) -> ActionTransformer | DirectTransformer:
    """Read back what `write_transformer` has written; it answers to the same bits.

    Raises:
      BadModelError: the folder holds no action transformer.
    """
    try:
        header = json.loads((folder / HEADER).read_text())
        if header["format"] != _FORMAT:
            raise ValueError(f"its format is {header['format']}")
        return _transformer(folder, header)
    except (OSError, KeyError, TypeError, ValueError) as error:
        raise BadModelError(f"{folder} holds no action transformer: {error}") from error


def _transformer(
    folder: Path, header: dict[str, Any]
) -> ActionTransformer | DirectTransformer:
    low, high = np.array(header["low"], float), np.array(header["high"], float)
    if header["kind"] == "direct":
        return DirectTransformer.load(folder / DIRECT, low, high)
    kind = DistributionalInverse if header["distributional"] else InverseModel
    white = header["noise_dimensions"]
    return ActionTransformer(
        ForwardModel.load(folder / FORWARD),
        kind.load(folder / INVERSE),
        low,
        high,
        None if white is None else WhiteNoise(white),
        header["smoothing"],
        header["inverse_columns"],
    )
