"""A made-up walk, and what was written of it into a Rerun file."""

import subprocess
import sys
from pathlib import Path

import numpy as np
from rerun.chunk import RrdReader
from scipy.spatial.transform import Rotation

import robots
from worlds.recordings.metadata import RecordingMetadata
from worlds.recordings.recording import Recording
from worlds.scenes.scene import Scene

NAO = robots.get("nao")
TICKS = 40
SENSORS = ("front_left", "front_right", "rear_left", "rear_right")


def walk_columns():
    """Legs that swing under a torso that moves on and turns."""
    time_s = 0.29 + 0.01 * np.arange(TICKS)
    columns = {"time": time_s}
    for k, joint in enumerate(NAO.joints):
        position = 0.4 * np.sin(6 * time_s + k)
        columns[f"position.{joint}"] = position
        columns[f"velocity.{joint}"] = 2.4 * np.cos(6 * time_s + k)
        columns[f"command.{joint}"] = position + 0.01
    turn = Rotation.from_rotvec(np.outer(time_s, [0, 0, 0.5]))
    place = np.stack([0.2 * time_s, 0 * time_s, 0.3 + 0 * time_s], axis=1)
    vectors = {
        "base.position": ("xyz", place),
        "base.orientation": ("wxyz", turn.as_quat(scalar_first=True)),
        "gyroscope": ("xyz", np.outer(time_s, [1, 2, 3])),
        "accelerometer": ("xyz", np.outer(time_s, [0, 1, 9.81])),
        "foot_force.left": (SENSORS, np.outer(time_s, [1, 2, 3, 4])),
        "foot_force.right": (SENSORS, np.outer(time_s, [4, 3, 2, 1])),
    }
    for vector, (components, values) in vectors.items():
        columns |= {f"{vector}.{c}": values[:, k] for k, c in enumerate(components)}
    columns["support"] = np.repeat([0.0, 1.0, -1.0, 1.0], TICKS // 4)
    return columns


def scene(name="sim", columns=None, ground=None, **about):
    metadata = RecordingMetadata("nao", "floating", "a test", **about)
    recording = Recording(walk_columns() if columns is None else columns, metadata)
    return Scene(name, recording, NAO, ground)


def read(path, entity):
    """All components of an entity, rows over time and those that are static."""
    found = {}
    for chunk in RrdReader(path).stream().filter(content=entity).to_chunks():
        batch = chunk.to_record_batch()
        found |= {name: batch.column(name) for name in batch.schema.names}
    return found


def entities(path):
    return {chunk.entity_path for chunk in RrdReader(path).stream().to_chunks()}


def scalars(path, entity):
    return read(path, entity)["Scalars:scalars"].flatten().to_numpy()


def ticks(path, entity):
    return read(path, entity)["tick"].to_numpy()


def components(path, entity, component, size):
    cells = read(path, entity)[component].flatten().flatten()
    return cells.to_numpy().reshape(-1, size)


def view_kinds(path):
    """Kinds of the views that the file's blueprint lays out."""
    (layout,) = RrdReader(path).blueprints()
    stream = RrdReader(path).stream(store=layout)
    views = [
        chunk.to_record_batch()
        for chunk in stream.to_chunks()
        if chunk.entity_path.startswith("/view/")
    ]
    component = "ViewBlueprint:class_identifier"
    return {
        kind
        for view in views
        if component in view.schema.names
        for kind in view.column(component).flatten().to_pylist()
    }


def rerun(*arguments):
    # Not by -m: version 0.41 then loses the exit status.
    command = [Path(sys.executable).with_name("rerun"), *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False)
