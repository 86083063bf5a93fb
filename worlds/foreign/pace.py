"""Makes recordings out of the data of PACE: arrays in a NumPy archive."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import numpy.typing as npt

from groundwalk.arrays import FloatArray
from groundwalk.errors import ForeignFileError, nearest_name
from worlds.foreign.recording import ForeignRecording, joint_columns

_ARRAYS = {
    "dof_pos": "position",
    "des_dof_pos": "command",
    "dof_vel": "velocity",
    "dof_torque": "torque",
}
_NEEDED = ("time", "dof_pos", "des_dof_pos")


def read_pace(path: Path) -> ForeignRecording:
    """Read `time` (T,) and `dof_pos`, `des_dof_pos` (T, j) from a .npz file.

    `dof_vel` and `dof_torque` (T, j) and `joint_names` (j,) are read where they are
    there; joints without names are called 1, 2 and so on. All is in SI units and
    radians.

    Raises:
      ForeignFileError: the file is damaged, lacks an array, or is one of PyTorch,
        which could run code; the message says how to make a .npz of it.
    """
    if path.suffix.lower() == ".pt":
        name, npz = path.name, f"{path.stem}.npz"
        raise ForeignFileError(
            f"{path}: files of PyTorch are not opened here; make a .npz of it: python "
            f"-c \"import numpy, torch; d = torch.load('{name}', weights_only=True); "
            f"numpy.savez('{npz}', **{{k: v.numpy() for k, v in d.items()}})\""
        )
    arrays = _arrays(path)
    for name in _NEEDED:
        if name not in arrays:
            close = nearest_name(name, arrays)
            hint = f"; is it {close!r}?" if close else ""
            raise ForeignFileError(
                f"{path}: no array {name!r}{hint}; needed are {', '.join(_NEEDED)}"
            )
    time_s = _floats(path, "time", arrays["time"])
    if time_s.ndim != 1:
        raise ForeignFileError(f"{path}: time has the shape {time_s.shape}, not (T,)")
    shape = (time_s.size, _floats(path, "dof_pos", arrays["dof_pos"]).shape[-1])
    joints = _joint_names(path, arrays, shape[1])
    columns = {"time": time_s}
    for name, quantity in _ARRAYS.items():
        if name not in arrays:
            continue
        values = _floats(path, name, arrays[name])
        if values.shape != shape:
            raise ForeignFileError(
                f"{path}: {name} has the shape {values.shape}, not {shape}"
            )
        columns |= joint_columns(quantity, joints, values)
    return ForeignRecording(path.stem, columns, f"PACE {path.name}")


def _joint_names(
    path: Path, arrays: Mapping[str, npt.NDArray[np.generic]], count: int
) -> tuple[str, ...]:
    if "joint_names" not in arrays:
        return tuple(str(k + 1) for k in range(count))
    names = tuple(map(str, arrays["joint_names"].ravel()))
    if len(names) != count:
        raise ForeignFileError(
            f"{path}: joint_names has {len(names)} names for {count} joints"
        )
    return names


def _arrays(path: Path) -> dict[str, npt.NDArray[np.generic]]:
    """All arrays of the archive; none that would need Python code to be run."""
    try:
        with path.open("rb") as file:
            archive = np.load(file, allow_pickle=False)
            if not hasattr(archive, "files"):
                raise ForeignFileError(f"{path}: one array, no archive of named ones")
            return {name: archive[name] for name in archive.files}
    except FileNotFoundError:
        raise ForeignFileError(f"{path}: no such file") from None
    except ForeignFileError:
        raise
    except Exception as error:
        # Damaged archives raise errors of many kinds, such as NotImplementedError.
        reason = str(error).partition("\n")[0] or type(error).__name__
        raise ForeignFileError(f"{path}: cannot be read as .npz: {reason}") from error


def _floats(path: Path, name: str, values: npt.NDArray[np.generic]) -> FloatArray:
    if values.dtype.kind not in "fiu" or values.ndim == 0:
        raise ForeignFileError(f"{path}: {name} holds no array of numbers")
    return values.astype(np.float64)
