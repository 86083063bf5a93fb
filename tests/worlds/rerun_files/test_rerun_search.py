import numpy as np
import pytest
from rrd_files import entities, read, rerun, scalars, view_kinds

from worlds.rerun_files.search import write_search
from worlds.rerun_files.search_history import SearchHistory

HISTORY = SearchHistory(
    rewards=[np.array([3.0, 1.0, 2.0]), np.array([5.0, -4.0, 6.0])],
    falls=np.array([0.0, 1.0]),
    mean_reward=np.array([2.5, 5.5]),
    mean={"period": np.array([0.2, 0.3])},
    spread={"period": np.array([0.05, 0.01])},
    best={"period": np.array([0.25, 0.31])},
    units={"period": "s", "reward": "cm/s"},
)


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    path = tmp_path_factory.mktemp("search") / "search.rrd"
    write_search(path, HISTORY, "an identity")
    return path


def test_rerun_finds_nothing_wrong_with_the_file(file):
    assert rerun("rrd", "verify", file).returncode == 0
    assert view_kinds(file) == {"TimeSeries", "BarChart", "TextDocument"}


@pytest.mark.parametrize(
    ("entity", "expected"),
    [
        ("reward/tried", [3, 2, 1, 6, 5, -4]),
        ("reward/best", [3, 6]),
        ("reward/middle", [2, 5]),
        ("reward/mean", [2.5, 5.5]),
        ("falls", [0, 100 / 3]),
        ("parameters/period/mean", [0.2, 0.3]),
        ("parameters/period/spread", [0.15, 0.25, 0.29, 0.31]),
        ("parameters/period/best", [0.25, 0.31]),
    ],
)
def test_columns_are_as_given(file, entity, expected):
    np.testing.assert_allclose(scalars(file, f"/search/{entity}"), expected)
    assert read(file, f"/search/{entity}")["generation"].to_pylist() == [0, 1]


def test_bars_count_the_gaits_of_a_generation(file):
    bars = read(file, "/search/rewards")
    assert "BarChart:values" in bars
    assert "/search/gait" in entities(file)


def test_the_page_names_best_and_mean(file):
    pages = read(file, "/search/gait")["TextDocument:text"].flatten().to_pylist()
    assert any("| period | s | 0.31 | 0.3 | 0.01 |" in page for page in pages)


def test_what_nobody_noted_is_left_out(tmp_path):
    path = tmp_path / "old.rrd"
    write_search(path, HISTORY._replace(mean={}, spread={}, best={}), "old")
    assert not any("parameters" in entity for entity in entities(path))
