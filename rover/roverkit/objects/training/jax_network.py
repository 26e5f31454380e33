"""The network in jax: its weights, and its operations."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from roverkit.objects.training.libraries import jax, jnp
from roverkit.objects.training.network import BOX, network

Weights = dict[str, Any]
"""Arrays by their names."""
EPSILON = 1e-3
"""Number that normalization adds to the variance."""
_MOMENTUM = 0.95
_RARE = 0.01
"""Score of all cells before training: most cells are no object (Lin et al., ICCV 2017)."""


def new_weights(seed: int, classes: int) -> tuple[Weights, Weights]:
    """Return random weights, and the means and variances of normalization before training."""
    first = _Initial(np.random.default_rng(seed))
    network(first, 3, classes)
    return first.weights, first.statistics


def outputs(
    weights: Mapping[str, Any], statistics: Mapping[str, Any], images: Any, *, train: bool
) -> tuple[Any, Weights]:
    """Return the outputs (B, H, W, 4 + C) for images (B, H, W, 3), and the new statistics of normalization.

    Images are RGB from 0 to 1. With `train`, features are normalized with the statistics of the batch.
    """
    do = _Jax(weights, statistics, train)
    classes = weights["head.2.bias"].shape[0] - BOX
    return network(do, images, classes), do.found


class _Initial:
    """Operations on the number of channels, which make the weights."""

    def __init__(self, rng: np.random.Generator) -> None:
        self._rng = rng
        self.weights: Weights = {}
        self.statistics: Weights = {}

    def convolve(self, x: int, name: str, channels: int, *, stride: int = 1, side: int = 3) -> int:  # noqa: ARG002
        self._kernel(name, side, x, channels)
        self.weights[f"{name}.scale"] = np.ones(channels, np.float32)
        self.weights[f"{name}.bias"] = np.zeros(channels, np.float32)
        self.statistics[f"{name}.mean"] = np.zeros(channels, np.float32)
        self.statistics[f"{name}.variance"] = np.ones(channels, np.float32)
        return channels

    def relu(self, x: int) -> int:
        return x

    def add(self, x: int, y: int) -> int:  # noqa: ARG002  # both are equal
        return x

    def enlarge(self, x: int) -> int:
        return x

    def predict(self, x: int, name: str, channels: int) -> int:
        self._kernel(name, 1, x, channels, 0.1)
        bias = np.zeros(channels, np.float32)
        bias[BOX:] = -math.log((1 - _RARE) / _RARE)
        self.weights[f"{name}.bias"] = bias
        return channels

    def _kernel(self, name: str, side: int, before: int, after: int, gain: float = 1.0) -> None:
        deviation = gain * math.sqrt(2 / (side * side * before))  # He et al., ICCV 2015
        self.weights[f"{name}.kernel"] = self._rng.normal(0, deviation, (side, side, before, after)).astype(np.float32)


class _Jax:
    """Operations on arrays (B, H, W, C)."""

    def __init__(self, weights: Mapping[str, Any], statistics: Mapping[str, Any], train: bool) -> None:
        self._weights, self._statistics, self._train = weights, statistics, train
        self.found: Weights = {}

    def convolve(self, x: Any, name: str, channels: int, *, stride: int = 1, side: int = 3) -> Any:  # noqa: ARG002
        x = self._convolved(x, name, stride)
        mean, variance = self._statistics[f"{name}.mean"], self._statistics[f"{name}.variance"]
        if self._train:
            now = x.mean((0, 1, 2)), x.var((0, 1, 2))
            for part, before, new in zip(("mean", "variance"), (mean, variance), now):
                self.found[f"{name}.{part}"] = _MOMENTUM * before + (1 - _MOMENTUM) * new
            mean, variance = now
        scale = self._weights[f"{name}.scale"] / jnp.sqrt(variance + EPSILON)
        return (x - mean) * scale + self._weights[f"{name}.bias"]

    def relu(self, x: Any) -> Any:
        return jax.nn.relu(x)

    def add(self, x: Any, y: Any) -> Any:
        return x + y

    def enlarge(self, x: Any) -> Any:
        return x.repeat(2, 1).repeat(2, 2)

    def predict(self, x: Any, name: str, channels: int) -> Any:  # noqa: ARG002
        return self._convolved(x, name, 1) + self._weights[f"{name}.bias"]

    def _convolved(self, x: Any, name: str, stride: int) -> Any:
        kernel = self._weights[f"{name}.kernel"]
        # The padding of ONNX and PyTorch; "SAME" of jax differs with a stride.
        around = (kernel.shape[0] // 2,) * 2
        return jax.lax.conv_general_dilated(
            x, kernel, (stride, stride), (around, around), dimension_numbers=("NHWC", "HWIO", "NHWC")
        )
