"""Makes recordings out of LeRobot's data sets (format v3), one an episode."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError, ForeignFileError
from groundwalk.json_data import is_number, parse_json
from worlds.foreign.joint_units import JointScale, joint_scales
from worlds.foreign.recording import ForeignRecording, joint_columns

INFO = Path("meta") / "info.json"
STATE, ACTION = "observation.state", "action"
_SAME_TIME_S = 1e-3
_COLUMNS = ("episode_index", "frame_index", "timestamp", STATE, ACTION)


@dataclass(frozen=True)
class LeRobotOptions:
    """What a data set does not say itself.

    Attributes:
      units: the unit of all joints, such as "deg", and of single ones, such as
        "gripper=percent_0_100".
      calibration: LeRobot's calibration file, which percentages need.
      without: joints that are left out, whose unit may stay unknown.
    """

    units: tuple[str, ...] = ()
    calibration: Path | None = None
    without: tuple[str, ...] = field(default=())


@dataclass(frozen=True)
class _Info:
    """What is needed of a data set's meta/info.json."""

    joints: tuple[str, ...]
    robot: str
    rate_hz: float


def is_lerobot(path: Path) -> bool:
    """Whether a path is the folder of a LeRobot data set."""
    return (path / INFO).is_file()


def read_lerobot(path: Path, options: LeRobotOptions) -> list[ForeignRecording]:
    """Read all episodes of a data set: action is the command, state the position.

    LeRobot measures, then acts, and keeps both as one frame: what format 1 says of a
    row. Its time stamps are those that the frames should have had.

    Raises:
      ForeignFileError: the data set is damaged or of another version, or it is open
        in which units its joints are.
    """
    info = _info(path)
    scales = joint_scales(
        str(path), info.joints, options.units, options.calibration, options.without
    )
    table = _frames(path)
    episodes = _numbers(path, table, "episode_index").astype(int)
    frames = _numbers(path, table, "frame_index")
    order = np.lexsort((frames, episodes))
    state = _vectors(path, table, STATE, len(info.joints))
    action = _vectors(path, table, ACTION, len(info.joints))
    time_s, note = _times(_numbers(path, table, "timestamp"), frames, info.rate_hz)
    found = []
    for episode in np.unique(episodes):
        rows = order[episodes[order] == episode]
        columns = {"time": time_s[rows]}
        columns |= _scaled("position", info.joints, state[rows], scales)
        columns |= _scaled("command", info.joints, action[rows], scales)
        found.append(
            ForeignRecording(
                f"{path.resolve().name}_episode_{episode:03d}",
                columns,
                f"LeRobot data set {path.resolve().name}, episode {episode}",
                (note,),
                info.robot,
            )
        )
    return found


def _times(
    stamps_s: FloatArray, frames: FloatArray, rate_hz: float
) -> tuple[FloatArray, str]:
    """Times [s] of all frames (rows,), and in words what they are.

    Stamps that are those of the rate are rounded to single precision in the file.
    """
    wanted_s = frames / rate_hz
    if np.max(np.abs(stamps_s - wanted_s), initial=0.0) < _SAME_TIME_S:
        return wanted_s, f"times are those wanted, {rate_hz:g} rows a second"
    return stamps_s, "times are the data set's own"


def _scaled(
    quantity: str,
    joints: Sequence[str],
    values: FloatArray,
    scales: Mapping[str, JointScale],
) -> dict[str, FloatArray]:
    """Columns in radians of the joints that have a scale; the others are left out."""
    raw = joint_columns(quantity, joints, values)
    return {
        name: scales[joint].radians(raw[name])
        for joint, name in zip(joints, raw, strict=True)
        if joint in scales
    }


def _info(path: Path) -> _Info:
    where = path / INFO
    try:
        plain = parse_json(where.read_bytes(), "it")
    except BadValueError as error:
        raise ForeignFileError(f"{where}: {error}") from None
    version = str(_key(where, plain, "codebase_version"))
    if not version.startswith("v3."):
        raise ForeignFileError(
            f"{where}: the data set has version {version}; v3 is read. LeRobot's own "
            "script convert_dataset_v21_to_v30 makes one of v2.1"
        )
    features = _key(where, plain, "features")
    names = [_joint_names(where, features, one) for one in (STATE, ACTION)]
    if names[0] != names[1]:
        raise ForeignFileError(
            f"{where}: {ACTION} is of {', '.join(names[1])}, {STATE} of "
            f"{', '.join(names[0])}; both must be of the same joints"
        )
    robot, rate = plain.get("robot_type") or "", _key(where, plain, "fps")
    if not (is_number(rate) and rate > 0):
        raise ForeignFileError(f"{where}: 'fps' must be a number above 0, not {rate!r}")
    return _Info(names[0], str(robot), float(rate))


def _key(where: Path, plain: Any, key: str) -> Any:
    if not isinstance(plain, dict) or key not in plain:
        raise ForeignFileError(f"{where}: has no {key!r}")
    return plain[key]


def _joint_names(where: Path, features: Any, feature: str) -> tuple[str, ...]:
    """Names of a feature's numbers; `shoulder_pan.pos` is the joint shoulder_pan."""
    names = _key(where, _key(where, features, feature), "names")
    while isinstance(names, dict) and len(names) == 1:
        (names,) = names.values()  # some programs write {"motors": [...]}
    if not isinstance(names, list) or not all(isinstance(one, str) for one in names):
        raise ForeignFileError(f"{where}: {feature} has no list of names of joints")
    other = [one for one in names if "." in one and not one.endswith(".pos")]
    if other:
        raise ForeignFileError(
            f"{where}: {feature} holds {other[0]!r}, no position of a joint"
        )
    return tuple(one.removesuffix(".pos") for one in names)


def _frames(path: Path) -> pa.Table:
    """All frames of a data set, of all its files, in any order."""
    files = sorted((path / "data").glob("chunk-*/file-*.parquet"))
    if not files:
        raise ForeignFileError(f"{path}: no data/chunk-*/file-*.parquet is in it")
    return pa.concat_tables(list(_tables(files)))


def _tables(files: Sequence[Path]) -> Iterator[pa.Table]:
    for file in files:
        try:
            names = pq.read_schema(file).names
            missing = [name for name in _COLUMNS if name not in names]
            if missing:
                raise ForeignFileError(f"{file}: has no column {missing[0]!r}")
            # Images are left unread.
            table = pq.read_table(file, columns=list(_COLUMNS))
        except (pa.ArrowException, OSError) as error:
            reason = str(error).partition("\n")[0]
            raise ForeignFileError(f"{file}: cannot be read: {reason}") from error
        yield table.replace_schema_metadata(None)


def _numbers(path: Path, table: pa.Table, column: str) -> FloatArray:
    try:
        values = table[column].cast(pa.float64()).to_numpy()
    except pa.ArrowException as error:
        raise ForeignFileError(f"{path}: column {column!r} holds no numbers") from error
    if not np.isfinite(values).all():
        raise ForeignFileError(f"{path}: a number is missing in column {column!r}")
    numbers: FloatArray = values
    return numbers


def _vectors(path: Path, table: pa.Table, column: str, count: int) -> FloatArray:
    """(rows, count) values of a column that holds a list of numbers a row."""
    try:
        rows = table[column].to_pylist()
        values = np.array(rows, np.float64).reshape(len(rows), -1)
    except (TypeError, ValueError) as error:
        raise ForeignFileError(
            f"{path}: column {column!r} does not hold one list of numbers a row"
        ) from error
    if values.shape[1] != count:
        raise ForeignFileError(
            f"{path}: column {column!r} has {values.shape[1]} numbers a row, "
            f"{INFO} names {count} joints"
        )
    return values
