"""Learning: the loss, and its minimization."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from roverkit.objects.training.jax_network import Weights, new_weights, outputs
from roverkit.objects.training.libraries import jax, jnp, optax
from roverkit.objects.training.network import BOX
from roverkit.objects.training.training_examples import BATCH, Batch, batches, random_order
from roverkit.objects.yolo_folder import LabelledImage
from roverlink.runtime.core.errors import SetupError

_RATE = 3e-3
"""Largest learning rate; it rises in the first twentieth of the training, and falls to 0 as a cosine."""
_DECAY = 1e-3
_BOX_WEIGHT = 1.0
Report = Callable[[int, int], None]
"""Function that is called with the steps done and their number."""


@dataclass(frozen=True, slots=True, eq=False)
class Learnt:
    """Network after a number of epochs, with what is needed to go on."""

    epochs: int
    weights: Weights
    statistics: Weights
    state: Sequence[Any]
    """Arrays of the optimizer."""


def learn(
    images: Sequence[LabelledImage],
    classes: int,
    size: tuple[int, int],
    epochs: int,
    seed: int,
    report: Report,
    begun: Learnt | None = None,
) -> Iterator[Learnt]:
    """Train a network with images, and yield it after each epoch. Raises `SetupError` if an image cannot be read.

    `size` is (width, height) of the network's input. A seed gives the same network on the same computer, also if the
    training goes on from `begun`.
    """
    weights, statistics = (begun.weights, begun.statistics) if begun else new_weights(seed, classes)
    steps = epochs * max(1, len(images) // BATCH)
    schedule = optax.warmup_cosine_decay_schedule(0.0, _RATE, max(1, steps // 20), max(2, steps))
    optimizer = optax.chain(optax.clip_by_global_norm(5.0), optax.adamw(schedule, weight_decay=_DECAY))
    state = optimizer.init(weights)
    structure = jax.tree.structure(state)
    if begun:
        state = jax.tree.unflatten(structure, begun.state)

    def step(weights: Any, statistics: Any, state: Any, batch: Any) -> Any:
        (value, found), slope = jax.value_and_grad(partial(loss, train=True), has_aux=True)(weights, statistics, *batch)
        change, state = optimizer.update(slope, state, weights)
        return optax.apply_updates(weights, change), found, state, value

    fast = jax.jit(step)
    rng = np.random.default_rng([seed, 1])
    done = 0
    for epoch in range(1, epochs + 1):
        order = random_order(len(images), rng)
        if begun and epoch <= begun.epochs:
            done += steps // epochs
            continue
        for batch in batches(images, size, classes, order):
            weights, statistics, state, value = fast(weights, statistics, state, _arrays(batch))
            done += 1
            report(done, steps)
        if not math.isfinite(float(value)):
            raise SetupError("the training diverged; use more images, or another --seed")
        yield Learnt(epoch, weights, statistics, jax.tree.leaves(state))


def loss(
    weights: Any, statistics: Any, images: Any, heat: Any, boxes: Any, cells: Any, *, train: bool
) -> tuple[Any, Weights]:
    """Return the loss of a batch, and the new statistics of normalization.

    The scores have the focal loss of CenterNet (Zhou et al., 2019, equation 1), the boxes the absolute error.
    """
    found, new = outputs(weights, statistics, images, train=train)
    logits, middle = found[..., BOX:], heat >= 0.9999
    sure = jax.nn.sigmoid(logits)
    hit = -((1 - sure) ** 2) * jax.nn.log_sigmoid(logits)
    miss = -((1 - heat) ** 4) * sure**2 * jax.nn.log_sigmoid(-logits)
    scores = jnp.where(middle, hit, miss).sum() / jnp.maximum(middle.sum(), 1)
    wrong = (jnp.abs(found[..., :BOX] - boxes).sum(-1) * cells).sum() / jnp.maximum(cells.sum(), 1)
    return scores + _BOX_WEIGHT * wrong, new


def _arrays(batch: Batch) -> tuple[Any, ...]:
    return batch.images, batch.heat, batch.boxes, batch.weights
