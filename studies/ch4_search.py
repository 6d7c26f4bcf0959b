"""A search over layers, nodes and activations beside the text's network."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from itertools import pairwise

import numpy as np
import torch
from ch4_runs import run
from further import Number
from torch import nn

from gaitdisc.networks.feedforward import FeedForward
from gaitdisc.networks.trainer import train
from gaitdisc.networks.training_settings import TrainingSettings


class Layers(nn.Module):
    """Hidden layers of one activation and a linear readout."""

    def __init__(self, inputs: int, outputs: int, layers: int, nodes: int, activation: type[nn.Module]) -> None:
        super().__init__()
        sizes = [inputs, *[nodes] * layers]
        pairs = [(nn.Linear(a, b), activation()) for a, b in pairwise(sizes)]
        self.hidden = nn.Sequential(*(each for pair in pairs for each in pair))
        self.readout = nn.Linear(nodes, outputs)

    def features(self, x: torch.Tensor) -> torch.Tensor:
        """What the linear layer reads."""
        return self.hidden(x)

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        """Scaled outputs."""
        return self.readout(self.hidden(x))


def search(quick: bool) -> Iterator[Number]:
    """The text's network against the winner of successive halving on inner blocks, on what neither saw."""
    of_text: dict[str, Callable] = {f"text, {n} nodes": partial(FeedForward, nodes=n) for n in (32, 64, 128)}
    others = {
        f"{layers} x {nodes} {word}": partial(Layers, layers=layers, nodes=nodes, activation=activation)
        for layers in (1, 2, 3)
        for nodes in (32, 64, 128)
        for word, activation in (("tanh", nn.Tanh), ("relu", nn.ReLU), ("logistic", nn.Sigmoid))
    }
    chosen = np.random.default_rng(0).permutation(len(others))[: 1 if quick else 5]
    builds = of_text | {name: others[name] for name in (list(others)[k] for k in chosen)}
    settings = TrainingSettings(epochs=1, decays=(0.1,))
    for who, condition in (("welk007", "natural"), ("welk007", "exotendon"), ("welk002", "natural")):
        training, held = run(who, condition)
        before, inner = training.last_block(0.15, 0.3)
        left, share = list(builds), 0.25
        while len(left) > 1:  # rungs: a quarter, a half, the whole of what is fitted
            part = before.last_block(share)[1] if share < 1 else before
            losses = {name: train(part, builds[name], settings, check=inner).losses for name in left}
            left = sorted(left, key=lambda name: min(losses[name]))[: max(1, len(left) // (4 if share == 1 else 2))]
            share = min(1.0, 2 * share)
        full = replace(settings, decays=TrainingSettings().decays)
        found = {"text, 64 nodes": FeedForward, "winner": builds[left[0]]}
        missed = {name: held.y - train(training, build, full).network(held.x) for name, build in found.items()}
        column = f"{who}, {condition}"
        for name, each in missed.items():
            share_left = np.mean(each**2, axis=0) / held.y.var(axis=0)
            yield Number(f"1 - R2, {name}", column, "", float(np.median(share_left)))
        strides = np.cumsum(np.diff(held.phi, prepend=0.0) < 0)
        gains = np.array([1 - np.sum(missed["winner"][strides == k] ** 2 / held.y.var(axis=0))
                          / np.sum(missed["text, 64 nodes"][strides == k] ** 2 / held.y.var(axis=0))
                          for k in np.unique(strides)[1:-1]])  # fmt: skip
        drawn = np.random.default_rng(0).choice(gains, (2000, len(gains))).mean(axis=1)
        for word, value in zip(
            ("low", "mean", "high"),
            (*np.quantile(drawn, [0.025]), gains.mean(), *np.quantile(drawn, [0.975])),
            strict=True,
        ):
            yield Number(f"error taken off by the winner, 95 % {word} [%]", column, "", 100 * float(value))
        yield Number(f"winner: {left[0]}", column, "", 1.0)
