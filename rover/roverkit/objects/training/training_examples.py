"""Examples for training: images with random changes, and what the network should say about them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roverkit.objects.detected_objects import Box
from roverkit.objects.training.network import BOX, SIZE_UNIT, STRIDE
from roverkit.objects.yolo_folder import Label, LabelledImage
from roverkit.vision.camera.camera_model import Floats
from roverkit.vision.markers.detection import Image
from roverkit.vision.opencv import cv2

BATCH = 16
"""Number of images that are learnt at once."""
_VISIBLE = 0.4
"""Least part of a box that must remain in a changed image."""
_NEAR = 0.5
"""Weight of a cell, relative to that of the middle, from which it learns the box."""


@dataclass(frozen=True, slots=True, eq=False)
class Batch:
    """Images with the outputs that the network should have."""

    images: NDArray[np.float32]
    """RGB images (B, H, W, 3) from 0 to 1."""
    heat: NDArray[np.float32]
    """Score (B, h, w, C) of each class: 1 at the middle of an object, less around it."""
    boxes: NDArray[np.float32]
    """Box (B, h, w, 4) in the units of the network's output."""
    weights: NDArray[np.float32]
    """Weight (B, h, w) of the box; 0 where there is none."""


@dataclass(frozen=True, slots=True, eq=False)
class Order:
    """Order in which images are learnt once, and the seeds of their random changes."""

    indices: NDArray[np.intp]
    seeds: NDArray[np.int64]


def random_order(images: int, rng: np.random.Generator) -> Order:
    """Return a random order of a number of images; few images are repeated in a batch."""
    indices = rng.permutation(max(images, BATCH)) % images
    return Order(indices, rng.integers(0, 2**63, len(indices)))


def batches(images: Sequence[LabelledImage], size: tuple[int, int], classes: int, order: Order) -> Iterator[Batch]:
    """Yield the images in an order and with random changes, once. `size` is (width, height) of the input.

    Raises `SetupError` if an image or its labels cannot be read.
    """

    def example(place: int) -> tuple[Image, list[Label]]:
        image, labels = images[order.indices[place]].read()
        return changed(image, labels, size, np.random.default_rng(order.seeds[place]))

    # The next images are read while the network learns.
    with ThreadPoolExecutor(1) as pool:
        groups = [range(start, start + BATCH) for start in range(0, len(order.indices) - BATCH + 1, BATCH)]
        waiting = [pool.submit(lambda group: [example(labelled) for labelled in group], group) for group in groups[:2]]
        for number in range(len(groups)):
            found = waiting.pop(0).result()
            if number + 2 < len(groups):
                waiting.append(pool.submit(lambda group: [example(labelled) for labelled in group], groups[number + 2]))
            yield batch(found, size, classes)


def batch(examples: Sequence[tuple[Image, Sequence[Label]]], size: tuple[int, int], classes: int) -> Batch:
    """Return a batch of BGR images of the network's size with their labels."""
    targets = [target(labels, size, classes) for _, labels in examples]
    images = (np.stack([image[..., ::-1] for image, _ in examples]) / 255).astype(np.float32)
    heat, boxes, weights = (np.stack(parts).astype(np.float32) for parts in zip(*targets))
    return Batch(images, heat, boxes, weights)


def changed(
    image: Image, labels: Sequence[Label], size: tuple[int, int], rng: np.random.Generator
) -> tuple[Image, list[Label]]:
    """Return an image of a size with its labels: scaled, moved, mirrored, with other light and colours."""
    height, width = image.shape[:2]
    fit = min(size[0] / width, size[1] / height)
    scale = fit * float(rng.uniform(0.75, 1.5))
    move = rng.uniform(-0.5, 0.5, 2) * np.abs(np.array(size) - scale * np.array([width, height]))
    mirror = rng.random() < 0.5
    x_scale = -scale if mirror else scale
    middle = np.array(size) / 2 + move
    start = middle - np.array([x_scale * width, scale * height]) / 2
    # Boxes are between the edges of pixels; OpenCV's integer coordinates are the middles of pixels.
    middles = start + np.array([x_scale, scale]) / 2 - 0.5
    matrix = np.array([[x_scale, 0, middles[0]], [0, scale, middles[1]]])
    shown = cv2.warpAffine(image, matrix, size, flags=cv2.INTER_AREA, borderValue=(114, 114, 114))
    found = []
    for index, box in labels:
        xs = sorted(x_scale * x + start[0] for x in (box.x, box.x + box.width))
        ys = [scale * y + start[1] for y in (box.y, box.y + box.height)]
        left, right = (float(np.clip(x, 0, size[0])) for x in xs)
        top, bottom = (float(np.clip(y, 0, size[1])) for y in ys)
        if (right - left) * (bottom - top) > _VISIBLE * (xs[1] - xs[0]) * (ys[1] - ys[0]):
            found.append((index, Box(left, top, right - left, bottom - top)))
    return _recoloured(shown, rng), found


def _recoloured(image: Image, rng: np.random.Generator) -> Image:
    gains = rng.uniform(0.65, 1.35) * rng.uniform(0.92, 1.08, 3)
    shown: Image = np.clip(image * gains + rng.uniform(-20, 20), 0, 255).astype(np.uint8)
    return shown


def target(labels: Sequence[Label], size: tuple[int, int], classes: int) -> tuple[Floats, Floats, Floats]:
    """Return `heat`, `boxes` and `weights` of one image."""
    width, height = size[0] // STRIDE, size[1] // STRIDE
    heat, boxes = np.zeros((height, width, classes), np.float32), np.zeros((height, width, BOX), np.float32)
    weights = np.zeros((height, width), np.float32)
    columns, rows = np.arange(width) + 0.5, np.arange(height) + 0.5
    for index, box in labels:
        x, y = (box.x + box.width / 2) / STRIDE, (box.y + box.height / 2) / STRIDE
        spread_x, spread_y = (max(0.5, length / STRIDE / 7) for length in (box.width, box.height))
        # The middle of the best cell has the score 1, wherever the middle of the object is in it.
        cell_x, cell_y = min(int(x), width - 1) + 0.5, min(int(y), height - 1) + 0.5
        bell = np.exp(-(((rows - cell_y) / spread_y) ** 2)[:, None] / 2 - ((columns - cell_x) / spread_x) ** 2 / 2)
        heat[..., index] = np.maximum(heat[..., index], bell)
        near = (bell >= _NEAR) & (bell > weights)
        weights[near] = bell[near]
        place = np.dstack(np.broadcast_arrays(x - columns[None], (y - rows)[:, None]))
        boxes[near, :2] = place[near]
        boxes[near, 2:] = np.log(np.maximum([box.width, box.height], 1.0) / SIZE_UNIT)
    return heat, boxes, weights
