import numpy as np
import pytest

from experiments.record import Record, main
from groundwalk.errors import BadValueError, GroundwalkError
from worlds import read_recording


def record(path, **options):
    main(Record(out=path, **({"robot": "pendulum", "duration": 2.0} | options)))
    return read_recording(path)


def test_a_recording_says_what_it_is(tmp_path):
    recording = record(tmp_path / "a.parquet")
    assert recording.joints == ("swing",)
    assert recording.metadata.base == "fixed"
    assert recording.metadata.servo["swing"].kp == 8.0
    assert recording.metadata.world == "real"
    assert (tmp_path / recording.metadata.robot).is_file()
    assert recording.duration_s == pytest.approx(2.0, abs=0.01)


def test_hidden_friction_shows_and_the_same_seed_gives_the_same_numbers(tmp_path):
    hidden = ("coulomb_friction@swing:torque=0.4",)
    rough, same, smooth = (
        record(tmp_path / f"{name}.parquet", hidden=effects).joint_values(
            "position", ["swing"]
        )
        for name, effects in (("rough", hidden), ("same", hidden), ("smooth", ()))
    )
    assert np.array_equal(rough, same)
    assert np.std(rough - smooth) > 0.005


def test_both_worlds_record_the_same_robot(tmp_path):
    one, other = (
        record(tmp_path / f"{world}.parquet", world=world).joint_values(
            "position", ["swing"]
        )
        for world in ("sim", "real")
    )
    assert np.std(one - other) < 0.001


@pytest.mark.slow
def test_a_robot_on_its_feet_is_recorded_with_its_base(tmp_path):
    path = tmp_path / "squat.parquet"
    recording = record(path, robot="nao", motion="squat", world="sim")
    assert recording.metadata.base == "floating"
    for vector in ("base.position", "gyroscope", "foot_force"):
        assert recording.has(vector)


@pytest.mark.parametrize(
    "options",
    [
        {"robot": "noa"},
        {"hidden": ("backlsh@swing:gap=0.1",)},
        {"hidden": ("backlash@swing:gap",)},
        {"duration": 0.0},
        {"seed": -1},
        {"base": "floating"},
        {"motion": "walk"},
        {"robot": "nao", "motion": "walk", "base": "fixed"},
    ],
)
def test_what_cannot_be_recorded_is_refused_at_once(tmp_path, options):
    with pytest.raises(GroundwalkError):
        Record(out=tmp_path / "a.parquet", **({"robot": "pendulum"} | options))


def test_a_place_that_is_not_there_is_refused(tmp_path):
    with pytest.raises(GroundwalkError, match="swing"):
        record(tmp_path / "a.parquet", hidden=("backlash@sving:gap=0.1",))
    assert not (tmp_path / "a.parquet").exists()


def test_nothing_is_overwritten(tmp_path):
    path = tmp_path / "a.parquet"
    path.write_text("mine")
    with pytest.raises(BadValueError, match="exists"):
        Record(out=path)
