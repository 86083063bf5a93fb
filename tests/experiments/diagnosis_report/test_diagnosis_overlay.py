import dataclasses

import made_up_diagnoses as made_up
import numpy as np
import pytest
from rerun.chunk import RrdReader

import robots
from diagnosis.conclude.held_out_series import ChannelSeries
from experiments.diagnosis_report.overlay import write_overlay
from groundwalk.errors import BadValueError

KNEE = f"/held_out/air_multisine_1/{made_up.WORST}"
SHORT = made_up.series(duration_s=0.5)


def chunks(path):
    return RrdReader(path).stream().to_chunks()


def entities(path):
    return {chunk.entity_path for chunk in chunks(path)}


def column(path, entity, name):
    for chunk in chunks(path):
        batch = chunk.to_record_batch()
        if chunk.entity_path == entity and name in batch.schema.names:
            return batch.column(name)
    raise KeyError(entity, name)


def numbers(path, entity, name="Scalars:scalars"):
    return column(path, entity, name).flatten().to_numpy()


def views(path):
    """Kinds of the views in the layout, with how many there are of each."""
    (layout,) = RrdReader(path).blueprints()
    batches = [
        chunk.to_record_batch()
        for chunk in RrdReader(path).stream(store=layout).to_chunks()
        if chunk.entity_path.startswith("/view/")
    ]
    name = "ViewBlueprint:class_identifier"
    found = [batch.column(name) for batch in batches if name in batch.schema.names]
    kinds = [kind for cells in found for kind in cells.flatten().to_pylist()]
    return {kind: kinds.count(kind) for kind in kinds}


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    path = tmp_path_factory.mktemp("overlay") / "overlay.rrd"
    odd = dataclasses.replace(SHORT, name="air steps[1-2 s]")
    write_overlay(path, [SHORT, odd], made_up.EFFECTS.fit)
    return path


def test_courses_and_errors_are_as_given(file):
    real, sim, corrected = SHORT.channels[made_up.WORST]
    course = numbers(file, f"{KNEE}/course").reshape(-1, 3)
    np.testing.assert_array_equal(course, np.stack([real, sim, corrected], axis=1))
    error = numbers(file, f"{KNEE}/error").reshape(-1, 2)
    in_mrad = 1e3 * np.stack([sim - real, corrected - real], 1)
    np.testing.assert_array_equal(error, in_mrad)
    names = column(file, f"{KNEE}/error", "SeriesLines:names").flatten().to_pylist()
    assert names == ["sim", "corrected"]
    times_ns = column(file, f"{KNEE}/error", "sim_time").cast("int64").to_numpy()
    np.testing.assert_array_equal(times_ns, np.rint(SHORT.time_s * 1e9))


def labels(path, name):
    """Texts of one kind in the layout, such as names of tabs or of plots."""
    (layout,) = RrdReader(path).blueprints()
    batches = [
        chunk.to_record_batch()
        for chunk in RrdReader(path).stream(store=layout).to_chunks()
    ]
    found = [batch.column(name) for batch in batches if name in batch.schema.names]
    return [text for cells in found for text in cells.flatten().to_pylist()]


def test_tabs_name_recording_and_quantity_and_plots_their_unit(file):
    tabs = labels(file, "ContainerBlueprint:display_name")
    for recording in ("air_multisine_1", "air steps[1-2 s]"):
        assert f"{recording}: position 1 to 4" in tabs
        assert f"{recording}: position 13 to 15" in tabs
    plots = labels(file, "ViewBlueprint:display_name")
    assert f"{made_up.WORST} [rad]" in plots
    assert "error [mrad]" in plots


def test_times_count_from_the_start_of_the_held_out_part(tmp_path):
    """The time cursor opens at 0, where there would be nothing to see."""
    path = tmp_path / "late.rrd"
    late = dataclasses.replace(SHORT, time_s=SHORT.time_s + 7.65)
    write_overlay(path, [late], made_up.EFFECTS.fit, robots.get("nao"))
    for entity in (f"{KNEE}/error", "/real/joints/LKneePitch/position"):
        times_ns = column(path, entity, "sim_time").cast("int64").to_numpy()
        assert times_ns[0] == 0


def test_every_channel_of_every_recording_is_there(file):
    found = entities(file)
    for joint in made_up.JOINTS:
        for name in ("air_multisine_1", "air-steps-1-2-s-"):
            assert f"/held_out/{name}/position.{joint}/course" in found
    assert not [name for name in found if name.startswith("/real")]
    assert views(file) == {"TimeSeries": 2 * 2 * len(made_up.JOINTS)}


def test_rows_with_missing_values_are_left_out(tmp_path):
    real, sim, corrected = SHORT.channels[made_up.WORST]
    gap = real.copy()
    gap[3:7] = np.nan
    channels = {made_up.WORST: ChannelSeries(gap, sim, corrected)}
    path = tmp_path / "gap.rrd"
    write_overlay(path, [dataclasses.replace(SHORT, channels=channels)])
    ticks = column(path, f"{KNEE}/error", "tick").to_numpy()
    np.testing.assert_array_equal(ticks, np.delete(np.arange(real.size), range(3, 7)))


def with_base(series):
    """The base moves on in real and stays in the sims."""
    rows = series.time_s.size
    still, moves = np.zeros(rows), np.linspace(0, 1, rows)
    parts = {f"base.position.{axis}": (still,) * 3 for axis in "yz"}
    parts["base.position.x"] = (moves, still, still)
    parts |= {f"base.orientation.{axis}": (still,) * 3 for axis in "xyz"}
    parts["base.orientation.w"] = (still + 1,) * 3
    channels = {name: ChannelSeries(*part) for name, part in parts.items()}
    return dataclasses.replace(series, channels={**series.channels, **channels})


def test_three_robots_stand_side_by_side(tmp_path):
    path = tmp_path / "robots.rrd"
    write_overlay(path, [with_base(SHORT)], made_up.EFFECTS.fit, robots.get("nao"))
    assert views(path)["3D"] == 3
    for version, way_m in (("real", 1.0), ("sim", 0.0), ("corrected", 0.0)):
        name = "Transform3D:translation"
        torso = column(path, f"/{version}/robot/torso", name).flatten().flatten()
        places_m = torso.to_numpy().reshape(-1, 3)
        assert np.ptp(places_m[:, 0]) == way_m
    knees = [
        numbers(path, f"/{version}/joints/LKneePitch/position")
        for version in ("real", "sim", "corrected")
    ]
    np.testing.assert_array_equal(knees, SHORT.channels[made_up.WORST])


def test_a_robot_whose_joints_are_not_there_is_not_shown(tmp_path):
    channels = {"position.elbow": SHORT.channels[made_up.WORST]}
    path = tmp_path / "arm.rrd"
    other = dataclasses.replace(SHORT, channels=channels)
    write_overlay(path, [other], description=robots.get("nao"))
    assert views(path) == {"TimeSeries": 2}


def test_nothing_is_no_overlay(tmp_path):
    with pytest.raises(BadValueError, match="no scenes"):
        write_overlay(tmp_path / "none.rrd", [])


def test_files_of_the_same_series_are_one_recording(tmp_path):
    def identity(series):
        path = tmp_path / "walk.rrd"
        write_overlay(path, series)
        (recording,) = RrdReader(path).recordings()
        return recording.recording_id

    assert identity([SHORT]) == identity([SHORT])
    assert identity([SHORT]) != identity([made_up.series(duration_s=0.5, seed=9)])
