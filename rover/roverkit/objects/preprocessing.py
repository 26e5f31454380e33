"""Preparation of images for a detector, and the way back from its coordinates to those of the image."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from roverkit.vision.camera.camera_model import Floats
from roverkit.vision.markers.detection import Image
from roverkit.vision.opencv import cv2

_PADDING = 114
"""Grey value of the border that letterboxes have in YOLOv5, YOLOv8 and YOLOX."""
_IMAGENET = np.array([0.485, 0.456, 0.406]), np.array([0.229, 0.224, 0.225])
"""Mean and standard deviation of the colours R, G, B in ImageNet, for values from 0 to 1."""


class Fit(Enum):
    """Way in which an image is brought to the size of the network's input."""

    CENTRED = "centred"
    """Scaled with its aspect ratio, with borders on both sides."""
    CORNER = "corner"
    """Scaled with its aspect ratio, with borders on the right or below."""
    STRETCHED = "stretched"
    """Scaled without its aspect ratio."""


@dataclass(frozen=True, slots=True)
class Placement:
    """Place of an image in the network's input: x' = x * scale + offset for the edges of pixels."""

    scale: tuple[float, float]
    offset: tuple[float, float]
    size: tuple[int, int]
    """Width and height of the image in pixels."""

    def to_image(self, boxes: Floats) -> Floats:
        """Return boxes (N, 4) of x1 y1 x2 y2 in pixels of the image, clipped to it."""
        corners = (boxes.reshape(-1, 2, 2) - self.offset) / self.scale
        clipped: Floats = np.clip(corners, 0, self.size).reshape(-1, 4)
        return clipped


@dataclass(frozen=True, slots=True)
class Preprocessing:
    """Preparation that a network expects."""

    fit: Fit = Fit.CENTRED
    rgb: bool = True
    """Order of the colours: R G B, or else B G R."""
    unit: bool = True
    """Values from 0 to 1, or else from 0 to 255."""
    normalized: bool = False
    """Values minus the mean of ImageNet's colours, divided by their standard deviation."""

    def prepare(self, image: Image, size: tuple[int, int]) -> tuple[NDArray[np.float32], Placement]:
        """Return the input (1, 3, H, W) for a BGR image (H, W, 3), and the place of the image in it.

        `size` is the width and height of the input.
        """
        height, width = image.shape[:2]
        placement = self._placement((width, height), size)
        inner = tuple(max(1, round(length * scale)) for length, scale in zip((width, height), placement.scale))
        resized = cv2.resize(image, inner, interpolation=cv2.INTER_LINEAR) if inner != (width, height) else image
        canvas = np.full((size[1], size[0], 3), _PADDING, np.uint8)
        left, top = (round(offset) for offset in placement.offset)
        canvas[top : top + inner[1], left : left + inner[0]] = resized
        scale = 1 / 255 if self.unit else 1.0
        blob: NDArray[np.float32] = cv2.dnn.blobFromImage(canvas, scale, swapRB=self.rgb)
        if self.normalized:
            mean, deviation = (values.reshape(1, 3, 1, 1).astype(np.float32) for values in _IMAGENET)
            blob = (blob - mean) / deviation
        return blob, placement

    def _placement(self, image: tuple[int, int], size: tuple[int, int]) -> Placement:
        if self.fit is Fit.STRETCHED:
            return Placement((size[0] / image[0], size[1] / image[1]), (0.0, 0.0), image)
        ratio = min(size[0] / image[0], size[1] / image[1])
        whole = math.floor if self.fit is Fit.CORNER else round  # as YOLOX, and as Ultralytics
        inner = [max(1, whole(length * ratio)) for length in image]
        # What is drawn has whole pixels, so the scales of both axes differ slightly.
        scale = inner[0] / image[0], inner[1] / image[1]
        if self.fit is Fit.CORNER:
            return Placement(scale, (0.0, 0.0), image)
        return Placement(scale, (float((size[0] - inner[0]) // 2), float((size[1] - inner[1]) // 2)), image)
