"""Which parts of recordings a case and its reference get, and which cases there are."""

from collections import Counter

import numpy as np
import pytest
from made_up_data import write_data

from experiments.concealed.doctored.parts import drawn_parts, rows
from experiments.concealed.doctored.plan import planned_real
from experiments.concealed.doctored.robots import (
    IN_MODEL,
    NOTHING,
    OUTSIDE,
    REAL_SETS,
    RealSet,
)
from experiments.concealed.doctored.sizes import SIZES, drawn_size
from groundwalk.errors import BadRecordingError
from worlds.recordings import Recording


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    folder = tmp_path_factory.mktemp("data")
    write_data(folder)
    return folder


def rng(seed):
    return np.random.default_rng(seed)


def stems(names):
    return {name.split("_", 1)[1] for name in names}


def test_many_recordings_are_drawn_and_long_ones_are_cut(data):
    sizes, lengths = set(), []
    for seed in range(12):
        parts = drawn_parts(data, REAL_SETS["so101"], "nominal.urdf", rng(seed))
        own, others = stems(parts.recordings), stems(parts.reference)
        assert not own & others
        sizes.add((len(own), len(others)))
        for name, one in {**parts.recordings, **parts.reference}.items():
            short = name.endswith("wave0")
            low, high = (14.9, 15.0) if short else (19.9, 30.1)
            assert low < one.duration_s < high
            assert one.time_s[0] == 0
            assert one.metadata.servo["elbow_flex"].kp == 7.8
            lengths.append(one.duration_s)
    assert sizes == {(3, 2), (3, 3), (4, 2), (4, 3)}
    assert np.ptp(lengths) > 5


def test_few_recordings_are_cut_and_of_two_neighbours_one_is_the_reference(data):
    seen = set()
    for seed in range(12):
        parts = drawn_parts(data, REAL_SETS["z1"], "nominal.xml", rng(seed))
        own, others = stems(parts.recordings), stems(parts.reference)
        assert own | others == {"a_0", "a_1", "b_0", "b_1"}
        assert len([name for name in own if name.startswith("a")]) == 1
        seen.add(tuple(sorted(own)))
    assert len(seen) == 4


def test_what_is_not_used_is_left_out(data):
    parts = drawn_parts(data, REAL_SETS["emps"], "nominal.xml", rng(1))
    for one in parts.recordings.values():
        assert set(one.columns) == {"time", "position.carriage", "torque.carriage"}


def test_a_joint_moves_if_it_does_so_twice_and_in_the_reference(data):
    parts = drawn_parts(data, REAL_SETS["z1"], "nominal.xml", rng(1))
    assert parts.moving() == ("joint2", "joint3")
    still = {}
    for k, (name, one) in enumerate(parts.recordings.items()):
        columns = dict(one.columns)
        if k == 0:
            columns["position.joint3"] = np.zeros(one.ticks)
        still[name] = Recording(columns, one.metadata)
    assert type(parts)(still, parts.reference).moving() == ("joint2",)
    assert type(parts)(parts.recordings, still).moving() == ("joint2", "joint3")


def test_rows_keep_their_distance_in_time(data):
    parts = drawn_parts(data, REAL_SETS["z1"], "nominal.xml", rng(1))
    whole = next(iter(parts.recordings.values()))
    some = rows(whole, 10, 20)
    assert (some.ticks, some.time_s[0]) == (10, 0)
    expected = whole.columns["position.joint2"][10:20]
    assert (some.columns["position.joint2"] == expected).all()


def test_one_recording_is_too_few(data, tmp_path):
    real = RealSet("emps", "emps/emps.xml", 1.0, ())
    with pytest.raises(BadRecordingError, match="two recordings"):
        drawn_parts(data, real, "nominal.xml", rng(1))


def plan(data, count=200, seed=1):
    return [planned_real(data, seed, count, k) for k in range(count)]


def test_a_set_holds_enough_doctored_and_undoctored_cases(tmp_path):
    for real in REAL_SETS.values():
        path = tmp_path / real.folder / real.files.replace("*", "one")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch()
    every = plan(tmp_path)
    done = Counter(what for _, what in every)
    assert done[NOTHING] >= 60
    assert len(every) - done[NOTHING] >= 120
    assert set(done) == {NOTHING, *OUTSIDE, *SIZES}
    assert {name for name, _ in every} == set(REAL_SETS)
    assert all(what in (NOTHING, *REAL_SETS[name].doctorings) for name, what in every)
    # a robot at which nothing may be doctored has its share of the cases all the same
    count = Counter(name for name, _ in every)
    assert count["pendulum_viscous"] == 0.04 * len(every)
    assert plan(tmp_path) == every != plan(tmp_path, seed=2)


def test_robots_without_recordings_are_left_out(data, tmp_path):
    assert {name for name, _ in plan(data)} == {"so101", "z1", "emps"}
    with pytest.raises(BadRecordingError, match="no recordings in any of so101"):
        plan(tmp_path)


def test_sizes_go_from_small_to_large_for_all_that_has_one():
    everything = {one for real in REAL_SETS.values() for one in real.doctorings}
    assert set(SIZES) == everything - set(OUTSIDE)
    assert set(IN_MODEL) <= set(SIZES)
    for name, (low, high) in SIZES.items():
        drawn = np.array([drawn_size(name, rng(k)) for k in range(200)])
        assert ((drawn >= low) & (drawn <= high)).all()
        middle = np.sqrt(low * high)
        assert 70 < (drawn < middle).sum() < 130  # even in the logarithm
