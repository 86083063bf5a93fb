"""Action transformers in folders: a header in JSON, and a file for each model."""

import json
from pathlib import Path
from typing import Any

import numpy as np

from groundwalk.errors import BadModelError, UnknownNameError
from groundwalk.files import write_text
from sgat.transformers.catalogue import kind_of_file
from sgat.transformers.transformer import KeptTransformer

HEADER = "transformer.json"
_FORMAT = 1


def write_transformer(folder: Path, transformer: KeptTransformer) -> None:
    """Write a transformer into a folder, which is made if it does not exist.

    Raises:
      BadValueError: the transformer is not fitted, or has other noise than white noise,
        whose data the files cannot hold.

    Example:
      See docs/python.md, "Learn with Gymnasium".
    """
    low, high = (bound.tolist() for bound in transformer.bounds)
    header: dict[str, Any] = {"format": _FORMAT, "low": low, "high": high}
    header |= {"kind": transformer.kind, **transformer.save(folder)}
    write_text(folder / HEADER, json.dumps(header, indent=1) + "\n")


def read_transformer(folder: Path) -> KeptTransformer:
    """Read a folder that `write_transformer` wrote.

    The transformer gives the same actions as the one that was written, to the last bit.

    Raises:
      BadModelError: the folder cannot be read, or holds no action transformer.

    Example:
      >>> transformer = read_transformer(Path("runs/sgat"))
    """
    try:
        header = json.loads((folder / HEADER).read_text())
        if header["format"] != _FORMAT:
            raise ValueError(f"its format is {header['format']}")
        low, high = np.array(header["low"], float), np.array(header["high"], float)
        return kind_of_file(header["kind"]).load(folder, header, low, high)
    except (OSError, KeyError, TypeError, ValueError, UnknownNameError) as error:
        raise BadModelError(f"{folder} holds no action transformer: {error}") from error
