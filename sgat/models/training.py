"""Training of small networks: Adam, early stopping, no global random numbers."""

import contextlib
import itertools
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple, Self

import torch
from torch import Tensor

from groundwalk.arrays import FloatArray
from sgat.models.config import NetworkConfig
from sgat.models.network import Network

Loss = Callable[[Tensor, Tensor], Tensor]
"""A function of raw outputs (members, n, outputs) and targets (n, d) that gives losses
(members, n)."""

_LARGEST_GRADIENT = 10.0
"""Largest norm of a network's gradient in scaled units; longer ones are shortened, so
that one outlier cannot undo an epoch."""


def squared_error(raw: Tensor, y: Tensor) -> Tensor:
    """(members, n) squared errors of the first d raw outputs against y (n, d)."""
    return (raw[..., : y.shape[-1]] - y).square().sum(dim=-1)


class Stage(NamedTuple):
    """A part of training; each stage starts from the best weights of the one before.

    Attributes:
      loss: is minimised.
      score: loss on held-out episodes that decides when to stop.
      rate: factor on the learning rate.
    """

    loss: Loss
    score: Loss
    rate: float = 1.0


class Examples(NamedTuple):
    """Training data in scaled units: inputs x (n, inputs) and targets y (n, d)."""

    x: Tensor
    y: Tensor

    @classmethod
    def of(cls, x: FloatArray, y: FloatArray) -> Self:
        """Examples from NumPy arrays (n, inputs) and (n, d)."""
        return cls(*(torch.tensor(array, dtype=torch.float32) for array in (x, y)))


def train(
    outputs: int,
    stages: Sequence[Stage],
    examples: Examples,
    weights: FloatArray,
    held_out: Examples,
    config: NetworkConfig,
    generator: torch.Generator,
) -> Network:
    """Train several networks of some `outputs` side by side, on a single thread.

    `weights` (members, n) are those of the examples in each network's loss. What is
    best for the held-out rows is kept. The generator draws the first weights and the
    order of the rows.
    """
    sizes = [examples.x.shape[1], *config.hidden, outputs]
    minds = torch.tensor(weights, dtype=torch.float32)
    with one_thread():
        parameters = _first_parameters(sizes, len(minds), generator)
        for stage in stages:
            epochs = _epochs(stage, parameters, examples, minds, config, generator)
            keeper = _BestWeights(parameters)
            keeper.look(_means(stage.score, parameters, held_out))
            for _ in itertools.islice(epochs, config.epochs):
                keeper.look(_means(stage.score, parameters, held_out))
                if keeper.epochs_without_better >= config.patience:
                    break
            keeper.restore()
    arrays = [parameter.detach().numpy() for parameter in parameters]
    return Network(tuple(arrays[::2]), tuple(arrays[1::2]))


@contextlib.contextmanager
def one_thread() -> Iterator[None]:
    """Let torch use one thread within the block, which is faster for small networks."""
    before = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        yield
    finally:
        torch.set_num_threads(before)


def _first_parameters(
    sizes: list[int], members: int, generator: torch.Generator
) -> list[Tensor]:
    """Weight, bias, weight ... of the layers, by Glorot and Bengio 2010, eq. 16."""
    parameters = []
    for inputs, outputs in itertools.pairwise(sizes):
        bound = (6 / (inputs + outputs)) ** 0.5
        uniform = torch.rand(members, inputs, outputs, generator=generator)
        parameters += [bound * (2 * uniform - 1), torch.zeros(members, 1, outputs)]
    for parameter in parameters:
        parameter.requires_grad_()
    return parameters


def raw_outputs(parameters: Sequence[Tensor], x: Tensor) -> Tensor:
    """(members, n, outputs) outputs of networks for x (n, inputs), with gradients."""
    values = x.expand(len(parameters[0]), *x.shape)
    for weight, bias in zip(parameters[:-2:2], parameters[1:-2:2], strict=True):
        values = torch.tanh(torch.baddbmm(bias, values, weight))
    return torch.baddbmm(parameters[-1], values, parameters[-2])


def _epochs(
    stage: Stage,
    parameters: list[Tensor],
    examples: Examples,
    minds: Tensor,
    config: NetworkConfig,
    generator: torch.Generator,
) -> Iterator[None]:
    """Train by one epoch at each step of the iterator, in random order of the rows."""
    rate = stage.rate * config.learning_rate
    optimiser = torch.optim.AdamW(
        parameters, lr=rate, weight_decay=config.weight_decay, fused=True
    )
    while True:
        order = torch.randperm(len(examples.x), generator=generator)
        for first in range(0, len(order), config.batch):
            rows = order[first : first + config.batch]
            losses = stage.loss(
                raw_outputs(parameters, examples.x[rows]), examples.y[rows]
            )
            optimiser.zero_grad()
            mean = (losses * minds[:, rows]).mean(dim=1)
            mean.sum().backward()  # type: ignore[no-untyped-call]
            _cut_gradients(parameters)
            optimiser.step()
        yield


def _cut_gradients(parameters: list[Tensor]) -> None:
    """Shorten each network's gradient to `_LARGEST_GRADIENT`, each on its own."""
    gradients = [p.grad for p in parameters if p.grad is not None]
    squares = torch.stack([g.square().sum(dim=(1, 2)) for g in gradients])
    norm = squares.sum(dim=0).sqrt()
    factor = (_LARGEST_GRADIENT / (norm + 1e-12)).clamp(max=1.0)
    for gradient in gradients:
        gradient *= factor[:, None, None]


@torch.no_grad()
def _means(score: Loss, parameters: list[Tensor], examples: Examples) -> Tensor:
    """(members,) mean score of each network over the examples."""
    return score(raw_outputs(parameters, examples.x), examples.y).mean(dim=1)


class _BestWeights:
    """Keeps the parameters of each network's own best epoch, during one stage."""

    def __init__(self, parameters: list[Tensor]) -> None:
        self._parameters = parameters
        self._best = [p.detach().clone() for p in parameters]
        self._score = torch.full((len(parameters[0]),), torch.inf)
        self.epochs_without_better = 0

    def look(self, score: Tensor) -> None:
        """Keep the parameters of networks whose `score` (members,) is a new minimum."""
        better = score < self._score
        self._score = torch.where(better, score, self._score)
        for best, now in zip(self._best, self._parameters, strict=True):
            best[better] = now.detach()[better]
        if better.any():
            self.epochs_without_better = 0
        else:
            self.epochs_without_better += 1

    @torch.no_grad()
    def restore(self) -> None:
        """Put the best parameters back into the networks."""
        for best, now in zip(self._best, self._parameters, strict=True):
            now.copy_(best)
