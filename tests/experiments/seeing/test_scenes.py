import numpy as np
import pytest
from made_up_runs import steady

import terrain
from experiments.seeing.scenes import make_scenes, read_recordings, scene_names
from groundwalk.errors import BadRecordingError
from worlds import write_recording

LUMPS = {"name": "lumps", "parameters": {"amplitude_m": 0.02}, "seed": 7}


def test_a_scene_has_the_ground_that_was_walked_on():
    (scene,) = make_scenes({"real/start": steady(terrain=LUMPS)})
    expected = terrain.make("lumps", seed=7, amplitude_m=0.02)
    assert scene.name == "real/start"
    assert scene.description.name == "nao"
    np.testing.assert_array_equal(scene.ground.heights_m, expected.heights_m)


def test_a_terrain_needs_no_more_than_a_name():
    (scene,) = make_scenes({"sim": steady(terrain={"name": "stairs"})})
    assert scene.ground.heights_m.max() == pytest.approx(0.05)  # five of 1 cm


def test_no_terrain_is_no_ground():
    (scene,) = make_scenes({"sim": steady()})
    assert scene.ground is None


@pytest.mark.parametrize(
    ("about", "words"),
    [
        ({"robot": "noa"}, "recording sim: unknown robot 'noa': did you mean 'nao'"),
        ({"terrain": {"name": "lump"}}, "recording sim: unknown terrain 'lump'"),
        (
            {"terrain": {"name": "lumps", "parameters": {"amplitude_m": -1}}},
            "recording sim: .*amplitude_m must be",
        ),
    ],
)
def test_what_is_not_known_here_is_named(about, words):
    with pytest.raises(BadRecordingError, match=words):
        make_scenes({"sim": steady(**about)})


def test_recordings_of_a_folder_are_read_those_of_the_sim_first(tmp_path):
    for name in ("real_tuned", "sim_tuned", "real_start", "sim_my_gait 2"):
        write_recording(steady(source=name), tmp_path / f"{name}.parquet")
    (tmp_path / "notes.txt").write_text("not a recording")
    recordings = read_recordings(tmp_path)
    assert list(recordings) == [
        "sim/my_gait-2",
        "sim/tuned",
        "real/start",
        "real/tuned",
    ]
    assert recordings["real/start"].metadata.source == "real_start"


def test_a_folder_that_is_not_there_has_no_recordings(tmp_path):
    assert read_recordings(tmp_path / "recordings") == {}


def test_every_text_becomes_a_name_that_a_scene_can_have():
    texts = ["sim/tuned", "_a b/.c", "größe", "ä", "a", "a"]
    names = scene_names(texts)
    assert names == ["sim/tuned", "a-b/c", "gr-e", "unnamed", "a", "a-2"]
    recording = steady()
    assert len(make_scenes(dict.fromkeys(names, recording))) == len(texts)
