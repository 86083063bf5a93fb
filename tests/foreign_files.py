"""Writes the files of other programs, as their own documentation describes them."""

import json

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

JOINT_STATE = "sensor_msgs/msg/JointState"
NUMBERS = "std_msgs/msg/Float64MultiArray"
TRAJECTORY = "trajectory_msgs/msg/JointTrajectory"
MS = 1_000_000
"""Nanoseconds."""

STORE = get_typestore(Stores.ROS2_HUMBLE)


def header(stamp_ns):
    time = STORE.types["builtin_interfaces/msg/Time"]
    stamp = time(sec=stamp_ns // 10**9, nanosec=stamp_ns % 10**9)
    return STORE.types["std_msgs/msg/Header"](stamp=stamp, frame_id="")


def joint_state(stamp_ns, names, position=(), velocity=(), effort=()):
    return STORE.types[JOINT_STATE](
        header=header(stamp_ns),
        name=list(names),
        position=np.array(position, float),
        velocity=np.array(velocity, float),
        effort=np.array(effort, float),
    )


def numbers(values):
    layout = STORE.types["std_msgs/msg/MultiArrayLayout"](dim=[], data_offset=0)
    return STORE.types[NUMBERS](layout=layout, data=np.array(values, float))


def trajectory(stamp_ns, names, *points):
    duration = STORE.types["builtin_interfaces/msg/Duration"](sec=0, nanosec=0)
    none = np.zeros(0)
    made = [
        STORE.types["trajectory_msgs/msg/JointTrajectoryPoint"](
            positions=np.array(point, float),
            velocities=none,
            accelerations=none,
            effort=none,
            time_from_start=duration,
        )
        for point in points
    ]
    return STORE.types[TRAJECTORY](
        header=header(stamp_ns), joint_names=list(names), points=made
    )


def write_bag(path, messages, mcap=False):
    """A bag's folder; `messages` are (topic, received [ns], message), in any order."""
    storage = StoragePlugin.MCAP if mcap else StoragePlugin.SQLITE3
    with Writer(path, version=9, storage_plugin=storage) as bag:
        made = {}
        for topic, received_ns, message in messages:
            kind = message.__msgtype__
            if topic not in made:
                made[topic] = bag.add_connection(topic, kind, typestore=STORE)
            bag.write(made[topic], received_ns, STORE.serialize_cdr(message, kind))
    (file,) = path.glob("*.mcap" if mcap else "*.db3")
    return file


def states(rows=5, names=("hip", "knee"), lag_ns=0, start_ns=0, **more):
    """State messages, 10 ms apart; row k has the positions k and -k."""
    return [
        (
            "/joint_states",
            start_ns + k * 10 * MS + lag_ns,
            joint_state(
                start_ns + k * 10 * MS,
                names,
                [k, -k],
                **{q: v[k] for q, v in more.items()},
            ),
        )
        for k in range(rows)
    ]


def write_lerobot(folder, episodes, names, version="v3.0", rate_hz=30, **info):
    """A LeRobot data set v3; `episodes` are (states, actions), each (rows, joints)."""
    features = {
        key: {"dtype": "float32", "shape": [len(names)], "names": list(names)}
        for key in ("action", "observation.state")
    }
    about = {
        "codebase_version": version,
        "robot_type": "so101_follower",
        "fps": rate_hz,
        "features": features,
        "data_path": "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet",
        **info,
    }
    (folder / "meta").mkdir(parents=True)
    (folder / "meta" / "info.json").write_text(json.dumps(about))
    (folder / "data" / "chunk-000").mkdir(parents=True)
    for number, (state, action) in enumerate(episodes):
        rows = len(state)
        table = pa.table(
            {
                "observation.state": listed(state),
                "action": listed(action),
                "timestamp": pa.array(np.arange(rows) / rate_hz, pa.float32()),
                "frame_index": pa.array(np.arange(rows), pa.int64()),
                "episode_index": pa.array(np.full(rows, number), pa.int64()),
                "task_index": pa.array(np.zeros(rows), pa.int64()),
            }
        )
        file = folder / "data" / "chunk-000" / f"file-{number:03d}.parquet"
        pq.write_table(table, file)
    return folder


def listed(values):
    values = np.asarray(values, np.float32)
    return pa.FixedSizeListArray.from_arrays(pa.array(values.ravel()), values.shape[1])


def write_calibration(path, **ranges):
    """LeRobot's calibration file; ranges are (range_min, range_max[, drive_mode])."""
    motors = {
        name: {
            "id": k,
            "drive_mode": one[2] if len(one) > 2 else 0,
            "homing_offset": 17,
            "range_min": one[0],
            "range_max": one[1],
        }
        for k, (name, one) in enumerate(ranges.items(), 1)
    }
    path.write_text(json.dumps(motors))
    return path
