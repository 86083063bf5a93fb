"""Model files: plain tensors and JSON, so that reading a file runs no code in it."""

import io
import json
from dataclasses import asdict
from pathlib import Path
from typing import TypeVar

import torch

from groundwalk.errors import BadModelError
from groundwalk.files import write_bytes
from groundwalk.json_data import from_plain
from sgat.models.network_config import NetworkConfig
from sgat.models.scaled_network import ScaledNetwork

Config = TypeVar("Config", bound=NetworkConfig)

_FORMAT = 1


def write_model(
    path: Path, kind: str, config: NetworkConfig, network: ScaledNetwork
) -> None:
    """Write a fitted network and its settings; the folder is made if it does not exist.

    `kind` names the kind of model, which `read_model` checks.
    """
    header = {"format": _FORMAT, "kind": kind, "config": asdict(config)}
    content = io.BytesIO()
    torch.save({"header": json.dumps(header), "tensors": network.to_tensors()}, content)
    write_bytes(path, content.getvalue())


def read_model(
    path: Path, kind: str, config_type: type[Config]
) -> tuple[Config, ScaledNetwork]:
    """Read a file that `write_model` wrote; all numbers are equal to the last bit.

    Only tensors and plain values are read (torch's `weights_only`), so no code of the
    file is run.

    Raises:
      BadModelError: the file cannot be read, is damaged, or has another kind of model.
    """
    try:
        file = io.BytesIO(path.read_bytes())
    except OSError as error:
        raise BadModelError(f"{path} cannot be read: {error.strerror}") from error
    try:
        content = torch.load(file, map_location="cpu", weights_only=True)
        header = json.loads(content["header"])
        found = header["format"], header["kind"]
        if found == (_FORMAT, kind):
            network = ScaledNetwork.from_tensors(content["tensors"])
            config = from_plain(config_type, header["config"], "config", False)
            return config, network
    except Exception as error:  # a file of another program can fail in any way
        raise BadModelError(f"{path} is no model file, or a damaged one") from error
    raise BadModelError(
        f"{path} holds a model of kind {found[1]!r}, format {found[0]}; wanted is "
        f"{kind!r}, format {_FORMAT}"
    )
