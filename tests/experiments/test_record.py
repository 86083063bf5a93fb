from dataclasses import replace

import numpy as np
import pytest

from diagnosis.residuals.predictor import Predictor
from diagnosis.traces.read import read_traces
from experiments.record import Record, main
from groundwalk.errors import BadValueError, GroundwalkError, UnknownNameError
from worlds import Load, read_recording


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


@pytest.mark.parametrize("world", ["sim", "real"])
def test_a_load_moves_with_the_robot_and_the_recording_states_it(tmp_path, world):
    load = ("link=0.4@0,0,-0.3",)
    free, loaded = (
        record(tmp_path / f"{name}.parquet", load=some, world=world)
        for name, some in (("free", ()), ("loaded", load))
    )
    assert (free.metadata.loads, loaded.metadata.loads) == (
        {}, {"link": Load(0.4, (0.0, 0.0, -0.3))},
    )  # fmt: skip
    moved = [one.joint_values("position", ["swing"]) for one in (free, loaded)]
    assert np.std(moved[0] - moved[1]) > 0.01
    paths = [tmp_path / f"{name}.parquet" for name in ("free", "loaded")]
    plant, traces = read_traces(paths, tmp_path / free.metadata.robot)

    def off(some):
        predictor = Predictor(plant, some)
        predictor.correct()  # how coarse the steps are is not the model's fault
        (left,) = predictor.residuals([()])
        return np.sqrt(np.mean(left**2))

    assert off(traces) < 1.3
    assert off([replace(one, loads={}) for one in traces]) > 5
    with pytest.raises(UnknownNameError, match="did you mean 'link'"):
        Record(out=tmp_path / "x.csv", robot="pendulum", load=("lonk=1@0,0,0",))
    with pytest.raises(BadValueError, match="names 'link' twice"):
        Record(out=tmp_path / "x.csv", robot="pendulum", load=load * 2)


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


def test_planned_motions_can_be_played_and_keep_the_limits(tmp_path, capsys):
    main(Record(out=tmp_path / "motions", robot="pendulum", plan=True))
    said = capsys.readouterr().out.splitlines()
    files = sorted(path.name for path in (tmp_path / "motions").iterdir())
    assert len(files) == 6
    assert all(any(line.startswith(f"{name}: ") for line in said) for name in files)
    played = tmp_path / "motions" / "reversals.csv"
    recording = record(tmp_path / "a.parquet", play=played)
    commands = np.loadtxt(played, delimiter=",", skiprows=1)
    assert recording.duration_s == pytest.approx(16.0, abs=0.01)
    sent = recording.joint_values("command", ["swing"])[:, 0]
    assert sent == pytest.approx(commands[:, 1], abs=1e-6)
    position = recording.joint_values("position", ["swing"])
    assert (np.abs(position) < 3.0).all()
    assert np.ptp(position) > 0.5


def test_motions_are_planned_for_a_model_file(tmp_path, capsys):
    record(tmp_path / "a.parquet")
    model = str(tmp_path / "a.nominal.xml")
    with pytest.raises(BadValueError, match="--kp"):
        main(Record(out=tmp_path / "motions", robot=model, plan=True))
    assert not (tmp_path / "motions").exists()
    gains = {"kp": 8.0, "kd": 0.2, "max_torque": 4.0, "max_speed": 1.0}
    main(Record(out=tmp_path / "motions", robot=model, plan=True, **gains))
    sweeps = tmp_path / "motions" / "sweeps.csv"
    table = np.loadtxt(sweeps, delimiter=",", skiprows=1)
    speed = np.abs(np.diff(table[:, 1]) / np.diff(table[:, 0])).max()
    assert 0.4 < speed < 0.52


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("time,command.elbow\n0,0\n1,1\n", "command.swing"),
        ("time,command.swing\n0,0\n", "missing"),
        ("time,command.swing\n0,0\n0,1\n", "forward"),
        ("time,command.swing\n0,zero\n", "CSV"),
        ("", "CSV"),
    ],
)
def test_a_file_that_cannot_be_played_is_refused(tmp_path, text, says):
    path = tmp_path / "play.csv"
    path.write_text(text)
    with pytest.raises(GroundwalkError, match=says):
        record(tmp_path / "a.parquet", play=path)


@pytest.mark.parametrize(
    "options",
    [
        {"kp": 8.0},
        {"max_speed": 1.0},
        {"plan": True, "max_speed": 0.0},
        {"robot": "nao", "motion": "walk", "play": "a.csv"},
    ],
)
def test_options_of_plans_belong_to_plans(tmp_path, options):
    with pytest.raises(BadValueError):
        Record(out=tmp_path / "a.parquet", **({"robot": "pendulum"} | options))
