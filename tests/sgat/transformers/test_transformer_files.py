"""Action transformers in folders."""

import json

import numpy as np
import pytest

from groundwalk.errors import BadModelError, BadValueError
from sgat.models.config import ForwardConfig, NetworkConfig
from sgat.models.transition_models import ForwardModel, InverseModel
from sgat.noise import BlockNoise, WhiteNoise
from sgat.transformers.action_transformer import ActionTransformer
from sgat.transformers.catalogue import read_transformer, write_transformer
from sgat.transformers.direct_transformer import DirectTransformer
from sgat.transitions import Transitions

TINY = {"hidden": (4,), "epochs": 1}
LOW, HIGH = np.full(2, -1.0), np.full(2, 1.0)


@pytest.fixture(scope="module")
def data():
    rng = np.random.default_rng(1)
    state, action = rng.normal(size=(80, 3)), rng.uniform(-1, 1, (80, 2))
    reached = state + action @ rng.normal(size=(2, 3))
    return Transitions(state, action, reached, np.repeat(np.arange(4), 20))


@pytest.fixture(scope="module")
def forward(data):
    return ForwardModel(ForwardConfig(**TINY)).fit(data, np.random.SeedSequence(1))


@pytest.fixture(scope="module")
def inverse(data):
    return InverseModel(NetworkConfig(**TINY)).fit(data, np.random.SeedSequence(2))


def answers(transformer, data):
    transformer.reset(np.random.SeedSequence(3).spawn(data.n))
    return transformer(data.state, data.action)


@pytest.mark.parametrize("noise", [None, WhiteNoise(3)])
def test_what_is_read_back_answers_to_the_same_bits(
    tmp_path, data, forward, inverse, noise
):
    before = ActionTransformer(forward, inverse, LOW, HIGH, noise, smoothing=0.7)
    write_transformer(tmp_path / "sgat", before)
    after = read_transformer(tmp_path / "sgat")
    assert (answers(before, data) == answers(after, data)).all()
    other = ActionTransformer(forward, inverse, LOW, HIGH, noise)
    assert (answers(other, data) != answers(after, data)).any()


def test_a_direct_transformer_comes_back(tmp_path, data, forward):
    before = DirectTransformer(LOW, HIGH, NetworkConfig(**TINY))
    before.fit(data, forward, data, np.random.SeedSequence(5))
    write_transformer(tmp_path, before)
    after = read_transformer(tmp_path)
    assert isinstance(after, DirectTransformer)
    assert (answers(before, data) == answers(after, data)).all()


def test_noise_that_holds_data_is_refused(tmp_path, data, forward, inverse):
    blocks = BlockNoise(forward.residuals(data), data.episode, 5)
    with pytest.raises(BadValueError, match="BlockNoise; only white"):
        write_transformer(
            tmp_path / "no", ActionTransformer(forward, inverse, LOW, HIGH, blocks)
        )
    assert not (tmp_path / "no").exists()


def test_folders_that_hold_none_are_refused(tmp_path, forward, inverse):
    with pytest.raises(BadModelError, match="holds no action transformer"):
        read_transformer(tmp_path)
    write_transformer(tmp_path, ActionTransformer(forward, inverse, LOW, HIGH))
    header = tmp_path / "transformer.json"
    found = json.loads(header.read_text())
    header.write_text(json.dumps(found | {"format": 9}))
    with pytest.raises(BadModelError, match="its format is 9"):
        read_transformer(tmp_path)
    header.write_text(json.dumps(found))
    (tmp_path / "forward.pt").write_bytes(b"")
    with pytest.raises(BadModelError, match=r"forward\.pt is no model file"):
        read_transformer(tmp_path)
