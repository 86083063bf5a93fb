import numpy as np
import pytest
from made_up_runs import history
from matplotlib.image import imread

from experiments.reports.report import write_figure
from experiments.seeing.run_pictures import search_figure
from groundwalk.errors import BadValueError


def lines_of(axes):
    return {line.get_label(): line for line in axes.lines}


def test_what_is_drawn_is_what_was_noted():
    above, below = search_figure(history(3)).axes
    lines = lines_of(above)
    assert lines["the mean gait"].get_xydata().tolist() == [
        [0, 0.5],
        [1, 1.5],
        [2, 2.5],
    ]
    assert lines["best"].get_ydata().tolist() == [3, 4, 5]
    tried = lines["gaits that were tried"].get_xydata()
    assert sorted(tried[:, 1]) == [-14, 1, 2, 3]
    assert np.abs(tried[:, 0]).max() < 0.5
    assert [bar.get_height() for bar in below.patches] == [25, 25, 25]
    assert "the mean gait fell" not in lines


def test_falls_of_the_mean_gait_are_marked():
    above, _ = search_figure(history(4, fell=[1, 3])).axes
    marked = lines_of(above)["the mean gait fell"].get_xydata()
    assert marked.tolist() == [[1, 1.5], [3, 3.5]]


def test_axes_say_what_they_show():
    above, below = search_figure(history(2)).axes
    assert "[cm/s]" in above.get_ylabel()
    assert "after a fall" in above.get_ylabel()
    assert "[%]" in below.get_ylabel()
    assert below.get_xlabel() == "generation"
    assert above.get_title().endswith("0.5 → 1.5 cm/s")


@pytest.mark.parametrize("generations", [1, 3, 100])
def test_generations_are_whole_numbers(generations):
    _, below = search_figure(history(generations)).axes
    low, high = below.get_xlim()
    assert (round(low), round(high)) == (-1, generations)
    assert all(tick == round(tick) for tick in below.get_xticks())


def test_the_file_is_a_picture_fit_for_a_page(tmp_path):
    path = tmp_path / "search.png"
    write_figure(search_figure(history(2)), path)
    rows, columns, _ = imread(path).shape
    assert 1200 <= columns <= 2400
    assert rows < columns


def test_the_same_search_gives_the_same_bytes(tmp_path):
    for name in ("a.png", "b.png"):
        write_figure(search_figure(history(2)), tmp_path / name)
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_nothing_to_draw(tmp_path):
    with pytest.raises(BadValueError, match="no generation"):
        write_figure(search_figure([]), tmp_path / "search.png")
    assert list(tmp_path.iterdir()) == []
