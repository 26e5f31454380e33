"""Network of the detector: what it consists of, in terms of operations that jax runs and that ONNX describes.

It is a small convolutional network with connections across its stages, as in feature pyramids (Lin et al., CVPR 2017).
Its output has one cell for 8x8 pixels of the image. A cell has a score for each class, which is high at the middle of
an object, and the offset and size of that object, as in CenterNet (Zhou et al., 2019).
"""

from __future__ import annotations

from typing import Protocol, TypeVar

STRIDE = 8
"""Width and height of a cell in pixels of the network's input."""
MULTIPLE = 32
"""Number by which width and height of the input must be divisible."""
SIZE_UNIT = 16.0
"""Width and height in pixels of an object whose logarithmic size is 0."""
BOX = 4
"""Outputs of a cell before those of the classes: x y of the offset in cells, logarithms of width and height."""

X = TypeVar("X")


class Operations(Protocol[X]):
    """Operations on feature maps."""

    def convolve(self, x: X, name: str, channels: int, *, stride: int = 1, side: int = 3) -> X:
        """Return a convolution to a number of channels, normalized over the batch; `name` is that of its weights."""

    def relu(self, x: X) -> X:
        """Return max(x, 0)."""

    def add(self, x: X, y: X) -> X:
        """Return the sum."""

    def enlarge(self, x: X) -> X:
        """Return the map with twice the width and height; each cell becomes four."""

    def predict(self, x: X, name: str, channels: int) -> X:
        """Return a convolution of single cells, with a bias and without normalization."""


def network(do: Operations[X], image: X, classes: int) -> X:
    """Return the outputs of the network for an image: `BOX` and the number of classes in each cell."""

    def block(x: X, name: str, channels: int, stride: int = 1, side: int = 3) -> X:
        return do.relu(do.convolve(x, name, channels, stride=stride, side=side))

    def residual(x: X, name: str, channels: int) -> X:
        inner = do.convolve(block(x, f"{name}.0", channels), f"{name}.1", channels)
        return do.relu(do.add(x, inner))

    x = block(block(image, "stem.0", 16, 2), "stem.1", 32, 2)
    eighth = residual(block(x, "eighth.0", 48, 2), "eighth.1", 48)
    sixteenth = residual(block(eighth, "sixteenth.0", 64, 2), "sixteenth.1", 64)
    sixteenth = residual(sixteenth, "sixteenth.2", 64)
    x = residual(block(sixteenth, "last.0", 96, 2), "last.1", 96)
    x = residual(x, "last.2", 96)
    x = do.add(do.enlarge(block(x, "up.0", 64, side=1)), sixteenth)
    x = do.add(do.enlarge(block(block(x, "up.1", 64), "up.2", 48, side=1)), eighth)
    return do.predict(block(block(x, "head.0", 64), "head.1", 64), "head.2", BOX + classes)
