"""Film of a rendered scene whose images carry their numbers, so that a receiver of any kind can be timed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from roverkit.objects.scenes import sequence
from roverkit.vision.markers.detection import Image
from roverkit.vision.opencv import cv2

_BITS = 16
_CELL = 16  # pixels: one macroblock, which survives the compression
_SCENES = 45


def draw_scenes(file: Path) -> None:
    """Render the images of a camera that moves along a panel, and save them for `film`, since this takes seconds."""
    np.save(file, np.stack([scene.image for scene in sequence(4, _SCENES, panel=True)]))


def film(size: tuple[int, int], file: Path) -> tuple[Image, ...]:
    """Return the saved images, forth and back again, of a size (width, height)."""
    forth = list(np.load(file))
    images = forth + forth[-2:0:-1]
    return tuple(image if size == (640, 480) else cv2.resize(image, size) for image in images)


def numbered(images: tuple[Image, ...], number: int) -> Image:
    """Return the image of a number, with the number as black and white squares in its upper left corner."""
    image: Image = images[number % len(images)].copy()
    bits = [255 * (number >> bit & 1) for bit in range(_BITS)]
    image[:_CELL, : _CELL * _BITS] = np.repeat(np.array(bits, np.uint8), _CELL)[None, :, None]
    return image


def number_of(image: Image) -> int:
    """Return the number of an image."""
    middles = image[_CELL // 2, _CELL // 2 : _CELL * _BITS : _CELL].reshape(_BITS, -1).mean(axis=1)
    return sum((value > 127) << bit for bit, value in enumerate(middles.tolist()))
