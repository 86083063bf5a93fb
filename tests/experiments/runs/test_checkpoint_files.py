import numpy as np

from diagnosis.search.hooks import Saved
from experiments.runs.checkpoint_files import CheckpointFiles


def test_what_is_saved_is_loaded_to_the_last_digit(tmp_path):
    files = CheckpointFiles(tmp_path / "stages")
    assert not files.exists()
    assert files.load("search-000") is None
    plain = [{"model": [["servo_gain", "elbow", [0.1 + 0.2]]], "selected": 1 / 3}]
    arrays = {"residual0": np.random.default_rng(1).normal(size=9), "axes": np.eye(2)}
    files.save("search-000", Saved(plain, arrays))
    found = files.load("search-000")
    assert found.plain == plain
    assert found.arrays.keys() == arrays.keys()
    for name, values in arrays.items():
        np.testing.assert_array_equal(found.arrays[name], values)
    files.delete()
    assert not files.exists()
