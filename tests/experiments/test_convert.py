"""`groundwalk convert`: options, what is printed, and what is written or not."""

import math
from pathlib import Path

import numpy as np
import pytest
from foreign_files import joint_state, states, write_bag, write_lerobot

from experiments.convert import Convert, convert, main
from groundwalk.errors import ForeignFileError, GroundwalkError
from worlds import Load, read_recording

LOG = "t_ms,q_swing_deg,cmd_swing_deg,heat\n" + "".join(
    f"{10 * k},{k},{2 * k},30\n" for k in range(5)
)
URDF = """<robot name="arm"><link name="base"/><link name="rod"><inertial>
<mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
</link><joint name="swing" type="continuous"><parent link="base"/><child link="rod"/>
<axis xyz="0 1 0"/></joint></robot>"""


@pytest.fixture
def log(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "log.csv").write_text(LOG)
    (tmp_path / "arm.urdf").write_text(URDF)
    return Path("log.csv")


def left(folder):
    return sorted(path.name for path in folder.iterdir())


def test_a_guess_is_shown_and_written_if_confirmed(log, tmp_path, capsys):
    before = left(tmp_path)
    with pytest.raises(GroundwalkError, match="--yes"):
        main(Convert((log,), out=Path("air.parquet")))
    shown = capsys.readouterr().out
    for words in ("position.swing  q_swing_deg    deg", "not used: heat"):
        assert words in shown
    assert left(tmp_path) == before
    main(Convert((log,), out=Path("air.parquet"), yes=True))
    assert "wrote air.parquet: 5 rows, 0.04 s, joints swing" in capsys.readouterr().out
    recording = read_recording(Path("air.parquet"))
    np.testing.assert_allclose(
        recording.columns["command.swing"], np.arange(5) * 2 * math.pi / 180
    )
    assert recording.metadata.source == "groundwalk convert: table log.csv"


def test_what_is_said_needs_no_confirmation(log):
    said = (
        ("time=t_ms*ms", "position.swing=q_swing_deg*deg"),
        ("command.swing=cmd_swing_deg*rad",),
    )
    (recording,) = convert(Convert((log,), out=Path("air.csv"), map=said)).values()
    assert recording.columns["command.swing"][1] == 2.0
    assert read_recording(Path("air.csv")).joints == ("swing",)


def test_what_is_known_of_the_robot_is_kept(log):
    options = {"robot": "arm.urdf", "kp": 8.0, "kd": 0.5, "max_torque": 3.0}
    config = Convert((log,), Path("new/air.parquet"), yes=True, source="Ann", **options)
    ((path, recording),) = convert(config).items()
    about = recording.metadata
    assert (about.base, about.source) == ("fixed", "Ann")
    assert (path.parent / about.robot).is_file()
    assert about.servo["swing"].kp == 8.0
    assert about.servo["swing"].max_torque == 3.0


def test_joints_must_be_those_of_the_robot(log, tmp_path):
    (tmp_path / "arm.urdf").write_text(URDF.replace("swing", "swinger"))
    with pytest.raises(GroundwalkError, match="--rename swing=swinger"):
        convert(Convert((log,), Path("a.parquet"), yes=True, robot="arm.urdf"))
    renamed = (("swing=swinger",),)
    config = Convert(
        (log,), Path("a.parquet"), yes=True, robot="arm.urdf", rename=renamed
    )
    (recording,) = convert(config).values()
    assert recording.joints == ("swinger",)


def test_a_bag_with_commands(tmp_path):
    command = ("/targets", 0, joint_state(0, ["hip"], [1.0]))
    write_bag(tmp_path / "arm", [*states(), command])
    config = Convert(
        (tmp_path / "arm",),
        tmp_path / "arm.parquet",
        command_topic="/targets",
        without=(("knee",),),
    )
    (recording,) = convert(config).values()
    assert recording.joints == ("hip",)
    assert "/targets" in recording.metadata.source


def test_each_episode_gets_a_file(tmp_path):
    episode = ([[0.0], [90.0]], [[1.0], [2.0]])
    write_lerobot(tmp_path / "set", [episode, episode], ["pan.pos"])
    config = Convert((tmp_path / "set",), tmp_path / "new", unit=(("deg",),))
    convert(config)
    assert left(tmp_path / "new") == [f"set_episode_{k:03d}.parquet" for k in range(2)]
    recording = read_recording(tmp_path / "new" / "set_episode_001.parquet")
    assert recording.metadata.robot == "so101_follower"
    with pytest.raises(GroundwalkError, match="exists already"):
        convert(config)
    with pytest.raises(GroundwalkError, match="2 recordings: give a folder"):
        convert(Convert((tmp_path / "set",), tmp_path / "a.csv", unit=(("deg",),)))


def test_a_folder_of_tables_is_read_file_by_file(log, tmp_path):
    folder = tmp_path / "logs"
    folder.mkdir()
    for name in ("b.csv", "a.csv"):
        (folder / name).write_text(log.read_text())
    (folder / "notes.md").write_text("no recording")
    convert(Convert((folder,), tmp_path / "new", yes=True))
    assert left(tmp_path / "new") == ["a.parquet", "b.parquet"]
    (tmp_path / "empty").mkdir()
    with pytest.raises(ForeignFileError, match="nor a file that is read"):
        Convert((tmp_path / "empty",), tmp_path / "other")


@pytest.mark.parametrize(("third", "times"), [(LOG, 1), (LOG.replace("heat", "h"), 2)])
def test_the_same_guesses_are_shown_once(log, tmp_path, capsys, third, times):
    folder = tmp_path / "logs"
    folder.mkdir()
    for name, text in (("a.csv", LOG), ("b.csv", LOG), ("c.csv", third)):
        (folder / name).write_text(text)
    convert(Convert((folder,), tmp_path / "new", yes=True))
    assert capsys.readouterr().out.count("known from") == times


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"sources": ()}, "no source"),
        ({"sources": (Path("none.csv"),)}, "no such file"),
        ({"out": Path("log.csv")}, "exists already"),
        ({"out": Path("air.txt")}, "a folder"),
        ({"kd": 1.0}, "without kp"),
        ({"rename": (("swing",),)}, "old=new"),
        ({"unit": (("deg",),)}, "unit is given, but no source is a lerobot"),
        ({"command_topic": "/a"}, "command-topic is given, but no source is a bag"),
    ],
)
def test_options_that_are_refused_at_once(log, options, words):
    with pytest.raises(GroundwalkError, match=words):
        Convert(**({"sources": (log,), "out": Path("air.parquet")} | options))


def test_an_error_in_the_second_source_leaves_nothing(log, tmp_path):
    (tmp_path / "other.csv").write_text(LOG.replace("20,2,4,30", "20,off,4,30"))
    before = left(tmp_path)
    with pytest.raises(GroundwalkError, match=r"row 2 .*'off'"):
        convert(Convert((log, Path("other.csv")), Path("new"), yes=True))
    assert left(tmp_path) == before


def test_times_that_go_back_are_refused_with_the_name_of_the_file(log, tmp_path):
    (tmp_path / "log.csv").write_text(LOG.replace("20,", "5,", 1))
    with pytest.raises(GroundwalkError, match=r"log: column 'time', row 2"):
        convert(Convert((log,), Path("new"), yes=True))


def test_a_known_load_is_kept(log):
    loads = (("rod=1.5@0,0.1,-0.2",),)
    options = {"robot": "arm.urdf", "yes": True, "load": loads}
    convert(Convert((log,), out=Path("loaded.parquet"), **options))
    metadata = read_recording(Path("loaded.parquet")).metadata
    assert metadata.loads == {"rod": Load(1.5, (0.0, 0.1, -0.2))}
    wrong = {**options, "load": (("road=1.5@0,0,0",),)}
    with pytest.raises(GroundwalkError, match=r"fixed to 'road'.*did you mean 'rod'"):
        convert(Convert((log,), out=Path("wrong.parquet"), **wrong))


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("rod", "must be BODY=KG@X,Y,Z"),
        ("rod=1.5", "must be BODY=KG@X,Y,Z"),
        ("rod=heavy@0,0,0", "must be BODY=KG@X,Y,Z"),
        ("=1.5@0,0,0", "must be BODY=KG@X,Y,Z"),
        ("rod=1.5@0,0", "must be BODY=KG@X,Y,Z"),
        ("rod=-1@0,0,0", "must be a number above 0, not -1.0"),
        ("rod=1@nan,0,0", "must be three numbers"),
    ],
)
def test_a_load_has_a_body_a_mass_and_a_place(log, text, problem):
    with pytest.raises(GroundwalkError, match=problem):
        Convert((log,), out=Path("loaded.parquet"), load=((text,),))
