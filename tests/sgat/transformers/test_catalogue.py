"""A grounding is known once its file is in the shelf."""

import inspect
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import sgat.transformers
from groundwalk.errors import BadValueError, UnknownNameError
from sgat.models.config import ForwardConfig
from sgat.noise import WhiteNoise
from sgat.transformers.catalogue import (
    add_grounding,
    grounding,
    groundings,
)
from sgat.transformers.grounding_base import GroundingData
from sgat.transitions import Transitions

LOW, HIGH = np.full(2, -1.0), np.full(2, 1.0)


def walks(seed, outcomes=3):
    rng = np.random.default_rng(seed)
    state, action = rng.normal(size=(80, 3)), rng.uniform(-1, 1, (80, 2))
    reached = state + action @ rng.normal(size=(2, 3))
    return Transitions(state, action, reached[:, :outcomes], np.arange(80) // 20)


@pytest.fixture
def data():
    seeds = np.random.SeedSequence(3).spawn(3)
    tiny = ForwardConfig(hidden=(4,), epochs=1)
    return GroundingData(walks(1), walks(2), LOW, HIGH, *seeds, tiny, walks(4))


def test_names_and_titles_lead_to_the_same_grounding():
    assert grounding("SGAT, uneven sim") is grounding("sgat-uneven")
    titles = [one.title for one in groundings().values()]
    assert len(set(titles)) == len(titles)


def test_the_face_offers_functions_and_no_modules():
    groundings()  # every file of the shelf is imported by now
    for name in sgat.transformers.__all__:
        assert not inspect.ismodule(getattr(sgat.transformers, name)), name


def test_a_misspelt_name_gets_the_nearest():
    with pytest.raises(UnknownNameError, match="did you mean 'sgat-full'"):
        grounding("sgat-ful")


def test_a_name_is_given_once():
    with pytest.raises(BadValueError, match="already"):
        add_grounding(grounding("gat"))


def test_models_are_fitted_once_and_shared(data):
    gat, sgat = (grounding(name).transformer(data) for name in ("gat", "sgat"))
    assert gat.forward is sgat.forward
    assert gat.inverse is sgat.inverse
    assert gat.noise is None
    assert sgat.noise == WhiteNoise(3)
    assert grounding("sgat-full").transformer(data).forward is not gat.forward
    assert not grounding("gat").is_random
    assert grounding("sgat").is_random


@pytest.mark.slow
def test_every_grounding_makes_a_transformer_within_the_bounds(data):
    state, action = walks(5).state, 3 * walks(5).action
    for one in groundings().values():
        if one.name == "sgat-ensemble":
            continue  # its blocks of 50 ticks are longer than these episodes
        transformer = one.transformer(data)
        transformer.reset(np.random.SeedSequence(6).spawn(80))
        given = transformer(state, action)
        assert given.shape == (80, 2)
        assert np.abs(given).max() <= 1


def test_an_uneven_sim_needs_its_walks(data):
    plain = GroundingData(
        data.real, data.sim, LOW, HIGH, data.seed, data.seed, data.seed
    )
    with pytest.raises(BadValueError, match="uneven"):
        grounding("sgat-uneven").transformer(plain)


NEW = '''
"""Mirrors actions: a grounding in one file."""

import json

from sgat.transformers.catalogue import add_grounding, file_kind
from sgat.transformers.grounding_base import Grounding


@file_kind
class Mirror:
    kind = "mirror"

    def __init__(self, low, high):
        self.bounds = low, high

    def reset(self, seeds):
        pass

    def __call__(self, state, action):
        return -action

    def save(self, folder):
        return {"mirrored": True}

    @classmethod
    def load(cls, folder, header, low, high):
        assert header["mirrored"]
        return cls(low, high)


class Mirrored(Grounding):
    name = "mirrored"
    title = "mirrored actions"

    def transformer(self, data):
        return Mirror(data.low, data.high)


add_grounding(Mirrored())
'''


def test_a_new_grounding_is_one_file(tmp_path):
    """A fresh process finds it by name, and reads its own kind of file back."""
    shelf, code = tmp_path / "shelf", tmp_path / "use.py"
    shelf.mkdir()
    (shelf / "mirrored.py").write_text(NEW)
    code.write_text(f"""
import pathlib, sys
import sgat.transformers
sgat.transformers.__path__.append({str(shelf)!r})
import numpy as np
from sgat.transformers.catalogue import grounding
from sgat.transformers.catalogue import read_transformer, write_transformer
class Data: low, high = np.full(2, -1.0), np.full(2, 1.0)
made = grounding("mirrored actions").transformer(Data)
write_transformer(pathlib.Path({str(tmp_path / "kept")!r}), made)
again = read_transformer(pathlib.Path({str(tmp_path / "kept")!r}))
print(type(again).__name__, again(None, 3.0))
""")
    root = Path(sgat.transformers.__file__).parents[2]
    done = subprocess.run(
        [sys.executable, code],
        cwd=root,
        env={"PYTHONPATH": str(root), "PATH": ""},
        capture_output=True,
        text=True,
    )
    assert done.stdout == "Mirror -3.0\n", done.stderr
