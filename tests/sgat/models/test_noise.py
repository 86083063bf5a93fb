"""Noise: each law has the moments that it claims, each robot its own stream."""

import math

import numpy as np
import pytest
from known_dynamics import seeds

from groundwalk.errors import BadValueError
from sgat.noise import BlockNoise, NoiseStream, WhiteNoise


def residuals_of_a_walk(seed=1):
    """Correlated in time and across, off in mean and variance; 9 uneven episodes."""
    lengths = [30, 80, 55, 19, 100, 64, 40, 75, 37]
    rng, rows = np.random.default_rng(seed), []
    for length in lengths:
        values = np.zeros((length, 2))
        for t in range(1, length):
            values[t] = 0.6 * values[t - 1] + rng.standard_t(5, 2) * [1.0, 0.2]
        rows.append(values @ [[1.0, 0.5], [0.0, 1.0]] + [0.3, -2.0])
    return np.concatenate(rows), np.repeat(np.arange(9), lengths)


BLOCK = BlockNoise(*residuals_of_a_walk(), ticks=20)
LAWS = [WhiteNoise(3), BLOCK]


def drawn(law, n, ticks, root=5):
    """(ticks, n, d)."""
    stream = NoiseStream(law, seeds(n, root))
    return np.array([stream.draw()[0] for _ in range(ticks)])


@pytest.mark.parametrize("law", LAWS)
def test_every_law_is_standardised(law):
    noise = drawn(law, 400, 400)
    assert noise.shape == (400, 400, law.dimensions)
    robots = noise.mean(axis=0)  # independent of each other
    error = robots.std(axis=0) / math.sqrt(400)
    assert (np.abs(noise.mean(axis=(0, 1))) < 5 * error).all()
    np.testing.assert_allclose(noise.var(axis=(0, 1)), 1, atol=0.04)
    np.testing.assert_allclose(noise[0].var(axis=0), 1, atol=0.45)  # from the start


def test_white_noise_is_white():
    noise = drawn(WhiteNoise(3), 300, 300)
    n = noise[1:].size / 3
    for later, before in ((noise[1:], noise[:-1]), (noise[..., 1:], noise[..., :-1])):
        assert np.abs((later * before).mean(axis=(0, 1))).max() < 5 / math.sqrt(n)
    assert np.abs(np.mean(noise**4, axis=(0, 1)) - 3).max() < 5 * math.sqrt(96 / n)


def test_blocks_are_pieces_of_one_episode():
    residuals, episode = residuals_of_a_walk()
    noise = drawn(BLOCK, 30, 120)
    pieces = noise.reshape(6, 20, 30, 2).transpose(0, 2, 1, 3).reshape(-1, 20, 2)
    for piece in pieces:
        assert any(
            same_shape(piece, residuals[i : i + 20])
            for i in range(len(residuals) - 19)
            if episode[i] == episode[i + 19]
        )


def same_shape(piece, other):
    """Whether one is the other scaled and moved, each dimension on its own."""
    off, theirs = piece - piece.mean(axis=0), other - other.mean(axis=0)
    return np.allclose(off / off.std(axis=0), theirs / theirs.std(axis=0))


def all_blocks(residuals, episode, ticks):
    """(blocks, ticks, d) every block there is."""
    starts = [
        i
        for i in range(len(residuals) - ticks + 1)
        if len(set(episode[i : i + ticks])) == 1
    ]
    return np.array([residuals[i : i + ticks] for i in starts])


@pytest.mark.parametrize("ticks", [1, 7, 20, 100])
def test_block_noise_is_standardised_as_it_is_drawn(ticks):
    """Exactly so, if every block came once."""
    residuals, episode = residuals_of_a_walk()
    law = BlockNoise(residuals, episode, ticks)

    class EveryBlock:
        def __init__(self):
            self.next = 0

        def integers(self, count, size):
            self.next += size
            return np.arange(self.next - size, self.next) % count

    blocks = len(all_blocks(residuals, episode, ticks))
    rounds = math.lcm(blocks, -(-64 // ticks)) // -(-64 // ticks)
    every = EveryBlock()
    noise = np.concatenate([law.chunk([every]) for _ in range(rounds)])[:, 0]
    np.testing.assert_allclose(noise.mean(axis=0), 0, atol=1e-9)
    np.testing.assert_allclose(noise.var(axis=0), 1, rtol=1e-9)


def test_block_noise_has_the_datas_memory_correlation_and_tails():
    residuals, episode = residuals_of_a_walk()
    blocks = all_blocks(residuals, episode, 20)
    unit = (blocks - blocks.mean(axis=(0, 1))) / blocks.std(axis=(0, 1))
    noise = drawn(BLOCK, 500, 400)
    # over one tick, 19 of 20 pairs are in the same block
    expected = (unit[:, 1:] * unit[:, :-1]).mean(axis=(0, 1)) * 19 / 20
    found = (noise[1:] * noise[:-1]).mean(axis=(0, 1))
    np.testing.assert_allclose(found, expected, atol=0.03)
    assert (expected > 0.4).all()
    across = (unit[..., 0] * unit[..., 1]).mean()
    assert (noise[..., 0] * noise[..., 1]).mean() == pytest.approx(across, abs=0.03)
    np.testing.assert_allclose(
        (noise**4).mean(axis=(0, 1)), (unit**4).mean(axis=(0, 1)), rtol=0.06
    )


def test_blocks_longer_than_any_episode_are_refused():
    residuals, episode = residuals_of_a_walk()
    assert BlockNoise(residuals, episode, 100).ticks == 100
    with pytest.raises(BadValueError, match="101 ticks; the longest has 100"):
        BlockNoise(residuals, episode, 101)
    with pytest.raises(BadValueError, match="0 ticks"):
        BlockNoise(residuals, episode, 0)


def test_noise_without_dimensions_is_refused():
    with pytest.raises(BadValueError, match="dimensions"):
        WhiteNoise(0)


# Streams


@pytest.mark.parametrize("law", LAWS)
def test_a_robots_noise_does_not_depend_on_its_neighbours(law):
    stream = NoiseStream(law, seeds(7))
    alone = NoiseStream(law, seeds(7)[3:4])
    assert (stream.member()[3:4] == alone.member()).all()
    for _ in range(200):
        (noise, choice), (its_noise, its_choice) = stream.draw(), alone.draw()
        np.testing.assert_array_equal(noise[3:4], its_noise)
        np.testing.assert_array_equal(choice[3:4], its_choice)
        assert (noise[2] != noise[3]).any()


@pytest.mark.parametrize("law", LAWS)
def test_the_same_seeds_give_the_same_noise_again(law):
    chosen = seeds(3)
    streams = [NoiseStream(law, chosen), NoiseStream(law, chosen)]
    for _ in range(70):
        np.testing.assert_array_equal(*(stream.draw()[0] for stream in streams))
    assert all(seed.n_children_spawned == 0 for seed in chosen)
    other = NoiseStream(law, seeds(3, root=6))
    assert (other.draw()[0] != NoiseStream(law, chosen).draw()[0]).any()


def test_choices_and_members_are_uniform_and_independent_of_the_noise():
    stream = NoiseStream(WhiteNoise(1), seeds(2000))
    member = stream.member()
    pairs = [stream.draw() for _ in range(100)]
    choice, noise = np.array([c for _, c in pairs]), np.array([z for z, _ in pairs])
    for uniform in (member, choice):
        assert ((uniform >= 0) & (uniform < 1)).all()
        shares = np.histogram(uniform, 10, (0, 1))[0] / uniform.size
        np.testing.assert_allclose(shares, 0.1, atol=5 * 0.3 / math.sqrt(uniform.size))
    assert abs(np.corrcoef(choice.ravel(), noise.ravel())[0, 1]) < 0.012
    np.testing.assert_array_equal(stream.member(), member)
