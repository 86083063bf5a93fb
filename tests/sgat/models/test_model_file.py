"""Model files: the same bits again, and nothing is run that is in them."""

import io
import os
import pickle

import numpy as np
import pytest
import torch
from known_dynamics import linear, noisy_actions, roll

from groundwalk.errors import BadModelError
from sgat.models.config import ForwardConfig, NetworkConfig
from sgat.models.transition_models import ForwardModel, InverseModel

WORLD = roll(noisy_actions(linear, 0.2), 8, 20, seed=71)
SEED = np.random.SeedSequence(72)


def forward(**options):
    config = ForwardConfig(hidden=(8, 9), epochs=2, **options)
    return ForwardModel(config).fit(WORLD, SEED)


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"beta": 0.5, "members": 3},
        {"head": "full"},
        {"head": "low-rank", "rank": 1},
        {"head": "mixture", "components": 4},
    ],
)
def test_a_forward_model_comes_back_to_the_bit(tmp_path, options):
    model = forward(**options)
    model.save(tmp_path / "new" / "forward.pt")
    again = ForwardModel.load(tmp_path / "new" / "forward.pt")
    assert again.config == model.config
    np.testing.assert_array_equal(again.residuals(WORLD), model.residuals(WORLD))
    asked = WORLD.state, WORLD.action
    np.testing.assert_array_equal(again.predict(*asked), model.predict(*asked))


def test_an_inverse_model_comes_back_to_the_bit(tmp_path):
    model = InverseModel(NetworkConfig(hidden=(7,), epochs=2)).fit(WORLD, SEED)
    model.save(tmp_path / "inverse.pt")
    again = InverseModel.load(tmp_path / "inverse.pt")
    assert again.config == model.config
    np.testing.assert_array_equal(
        again.predict(WORLD.state, WORLD.next_state),
        model.predict(WORLD.state, WORLD.next_state),
    )


def assert_refused(path, words, model=ForwardModel):
    with pytest.raises(BadModelError, match=words) as caught:
        model.load(path)
    assert len(str(caught.value).splitlines()) == 1
    assert str(path) in str(caught.value)


class Bomb:
    """Pickled, an order to make a file."""

    def __init__(self, path):
        self.path = path

    def __reduce__(self):
        return os.mkdir, (str(self.path),)


@pytest.mark.parametrize("way", ["pickle", "torch", "inside"])
def test_loading_a_foreign_file_runs_no_code(tmp_path, way):
    path, crater = tmp_path / "model.pt", tmp_path / "crater"
    if way == "pickle":
        path.write_bytes(pickle.dumps(Bomb(crater)))
    else:
        content = {"header": "{}", "tensors": {"weights.0": Bomb(crater)}}
        torch.save(Bomb(crater) if way == "torch" else content, path)
    assert_refused(path, "is no model file")
    assert not crater.exists()
    if way == "pickle":  # it would have gone off
        pickle.loads(path.read_bytes())
    else:
        torch.load(path, weights_only=False)
    assert crater.exists()


def test_the_other_kind_of_model_is_refused(tmp_path):
    path = tmp_path / "model.pt"
    forward().save(path)
    assert_refused(path, "kind 'forward'.*wanted is 'inverse'", InverseModel)


def test_no_file_no_model(tmp_path):
    assert_refused(tmp_path / "none.pt", "cannot be read: No such file")
    assert_refused(tmp_path, "cannot be read")


@pytest.mark.parametrize("share", [0.0, 0.1, 0.5, 0.9, 0.999])
def test_half_a_file_is_refused(tmp_path, share):
    path = tmp_path / "model.pt"
    forward().save(path)
    ForwardModel.load(path)
    content = path.read_bytes()
    path.write_bytes(content[: int(share * len(content))])
    assert_refused(path, "is no model file")


def test_text_is_no_model(tmp_path):
    path = tmp_path / "model.pt"
    path.write_text("hidden = [64, 64]\n")
    assert_refused(path, "is no model file")


def tampered(change):
    """A forward model's file after a change of its content."""
    content = io.BytesIO()
    torch.save(change, content)
    return content.getvalue()


@pytest.mark.parametrize(
    "name", ["inputs.mean", "targets.scale", "weights.1", "biases.2", "weights.2"]
)
@pytest.mark.parametrize("way", ["missing", "shape"])
def test_numbers_that_do_not_fit_each_other_are_refused(tmp_path, name, way):
    path = tmp_path / "model.pt"
    forward().save(path)
    content = torch.load(path, weights_only=True)
    if way == "missing":
        del content["tensors"][name]
    else:
        content["tensors"][name] = content["tensors"][name][..., :-1]
    torch.save(content, path)
    assert_refused(path, "is no model file")


def test_a_config_of_another_network_is_refused(tmp_path):
    path = tmp_path / "model.pt"
    forward().save(path)
    right = torch.load(path, weights_only=True)
    for before, after in (
        ('"gaussian"', '"full"'),
        ('"gaussian"', '"none"'),
        ('"members": 1', '"members": 2'),
        ('"epochs"', '"epoch"'),
    ):
        assert before in right["header"]
        wrong = right | {"header": right["header"].replace(before, after)}
        torch.save(wrong, path)
        assert_refused(path, "is no model file")
