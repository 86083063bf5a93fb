import numpy as np
import pytest
from made_up_runs import steady
from matplotlib.colors import to_rgb
from matplotlib.image import imread

from experiments.seeing.scenes import make_scenes
from experiments.seeing.walk_figure import ENDED, LEGS, draw_walk, walk_figure
from experiments.seeing.walk_strip import walk_strip
from groundwalk.errors import BadValueError

WALKS = {
    "sim/start": steady(0.2, 6.0, terrain={"name": "flat"}),
    "sim/tuned": steady(0.4, 6.0, terrain={"name": "flat"}),
    "real/start": steady(0.1, 3.0, terrain={"name": "lumps"}, end="fall"),
}


def figure_of(recordings):
    scenes = make_scenes(recordings)
    return walk_figure({scene.name: walk_strip(scene) for scene in scenes})


def shows(path, colour):
    """Whether a PNG has pixels of exactly this colour."""
    pixels = imread(path)[:, :, :3]
    return bool((np.abs(pixels - to_rgb(colour)) < 1 / 255).all(axis=2).any())


def test_worlds_side_by_side_and_gaits_below_each_other():
    start_sim, start_real, tuned_sim, empty = figure_of(WALKS).axes
    assert start_sim.get_title("left") == "sim, start: 20.0 cm/s"
    assert start_real.get_title("left") == "real, start: 10.0 cm/s, fall at 3.0 s"
    assert tuned_sim.get_title("left") == "sim, tuned: 40.0 cm/s"
    assert not empty.axison
    assert (tuned_sim.get_xlabel(), start_sim.get_xlabel()) == ("x [m]", "")


def test_all_panels_have_one_scale():
    figure = figure_of(WALKS)
    figure.draw_without_rendering()
    scales = set()
    for axes in figure.axes[:3]:
        box = axes.get_window_extent()
        across, up = np.ptp(axes.get_xlim()), np.ptp(axes.get_ylim())
        assert box.width / across == pytest.approx(box.height / up)
        scales.add(round(box.width / across))
    assert len(scales) == 1


def test_the_picture_marks_a_fall_and_nothing_else_in_that_colour(tmp_path):
    fallen, upright = tmp_path / "fallen.png", tmp_path / "upright.png"
    draw_walk({"real/start": WALKS["real/start"]}, fallen)
    draw_walk({"sim/start": WALKS["sim/start"]}, upright)
    assert shows(fallen, ENDED)
    assert not shows(upright, ENDED)
    for colour in LEGS.values():
        assert shows(upright, colour)


def test_times_stand_above_clear_figures():
    (axes,) = figure_of({"sim": steady(0.5, 1.0)}).axes
    texts = {text.get_text(): text.xy[0] for text in axes.texts}
    assert texts["1.0 s"] == pytest.approx(0.5)


def test_nothing_to_draw(tmp_path):
    with pytest.raises(BadValueError, match="no recording"):
        draw_walk({}, tmp_path / "walk.png")
    assert list(tmp_path.iterdir()) == []
