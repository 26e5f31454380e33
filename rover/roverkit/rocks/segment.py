"""Segment of a depth image that stands above the ground at a line.

1. Heights above the ground are averaged over a few pixels. Their spread around the line is that of the noise and of the
   rough ground together. What is higher than three of it stands above the ground.
2. The segment is the connected part of that with most pixels at the line.

Rocks that touch each other may be one segment; `extent` divides it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roverkit.rocks.ground import NOISE, Ground
from roverkit.vision.camera.camera_model import Floats
from roverkit.vision.opencv import cv2

_SIGMAS = 3.0
"""Spreads of the ground's heights above which something stands above the ground."""
_LOWEST_M = 0.004
"""Least height in metres of what stands above the ground."""
_WINDOW = 5  # pixels over which heights are averaged
_KNOWN = 0.3  # least share of the window's pixels with a depth
_STEEPEST = 5.7
"""Tangent of the largest angle at which a surface is measured, 80 degrees: what is seen as steeper is a mixture of
the depths before and behind an edge."""
_NOISES = 2.0
"""Largest difference of neighbouring inverse depths, in deviations: neighbours share most of the noise."""
_AT_LINE = 0.12  # distance from the line, as a fraction of its length, up to which a pixel is at the line


@dataclass(frozen=True, slots=True, eq=False)
class DepthPatch:
    """Rectangular part of a depth image around a line; its arrays have one entry for each of its pixels, by rows."""

    shape: tuple[int, int]
    """Rows and columns."""
    pixels: NDArray[np.intp]
    """Pixels (N, 2) of the image."""
    directions: Floats
    """Points (N, 3) in the plane z = 1 that the camera sees."""
    depth: Floats
    """Depths (N,) in metres; 0 where it is missing."""
    distances: Floats
    """Distances (N,) from the line in pixels."""
    along: Floats
    """Places (N,) of the nearest points of the endless line: 0 is its first end, 1 its last one."""

    @property
    def pitch(self) -> float:
        """Size of a pixel in the plane z = 1."""
        return float(np.linalg.norm(self.directions[-1] - self.directions[0]) / math.hypot(*np.subtract(self.shape, 1)))

    def averaged(self, values: Floats, mask: NDArray[np.bool_]) -> tuple[Floats, Floats]:
        """Return the means (N,) over the pixels of a mask around each pixel, and the share of those pixels."""
        wanted = mask.reshape(self.shape).astype(np.float32)
        share = cv2.blur(wanted, (_WINDOW, _WINDOW), borderType=cv2.BORDER_REPLICATE)
        total = cv2.blur(
            np.where(mask, values, 0).reshape(self.shape).astype(np.float32) * wanted,
            (_WINDOW, _WINDOW),
            borderType=cv2.BORDER_REPLICATE,
        )
        return (total / np.maximum(share, 1e-6)).ravel().astype(float), share.ravel().astype(float)


@dataclass(frozen=True, slots=True, eq=False)
class Segment:
    """Part of a depth image that stands above the ground at a line."""

    inside: NDArray[np.bool_]
    """Mask of the patch: the segment's pixels that have a depth."""
    pixels: NDArray[np.intp]
    """Those N pixels (N, 2) of the image."""
    directions: Floats
    """Directions (N, 3) of their rays: depth * direction is the point that a pixel shows."""
    depth: Floats
    """Depths (N,) in metres, averaged over neighbours in the segment."""
    lowest: float
    """Height in metres above which something stands above the ground here."""

    @property
    def points(self) -> Floats:
        """Points (N, 3) of the surface."""
        return self.directions * self.depth[:, None]


def find_segment(patch: DepthPatch, ground: Ground, around: NDArray[np.bool_], span: float) -> Segment | None:
    """Return what stands above the ground at the line; None if nothing does.

    ``around`` is the mask (N,) of the pixels by which the spread of the ground's heights is measured, and ``span`` the
    line's length in pixels.
    """
    has_depth = patch.depth > 0
    heights, share = patch.averaged(_heights(ground, patch.directions, patch.depth), has_depth)
    known = has_depth & (share >= _KNOWN)
    lowest = max(_SIGMAS * _spread(heights[around & known]), _LOWEST_M)
    jump = _STEEPEST * patch.pitch * patch.depth + _NOISES * NOISE * patch.depth**2
    depth = np.where(has_depth, patch.depth, np.inf).reshape(patch.shape).astype(np.float32)
    nearest = cv2.erode(depth, np.ones((3, 3), np.uint8), borderType=cv2.BORDER_REPLICATE).ravel()
    edge = has_depth & (patch.depth - nearest > jump)
    high = (known & ~edge & (heights > lowest)).reshape(patch.shape).astype(np.uint8)
    high = cv2.morphologyEx(high, cv2.MORPH_OPEN, np.ones((3, 3), np.uint8))
    # What is unsure may not divide a rock.
    sure = (known & ((heights <= lowest / 2) | (heights > lowest))).reshape(patch.shape)
    closed = cv2.morphologyEx(high, cv2.MORPH_CLOSE, np.ones((_WINDOW, _WINDOW), np.uint8))
    count, parts = cv2.connectedComponents(np.where(sure, high, closed))
    parts = parts.ravel()
    at_line = (patch.distances <= _AT_LINE * span) & (patch.along > 0) & (patch.along < 1)
    votes = np.bincount(parts[at_line], minlength=count)
    votes[0] = 0
    if not votes.any():
        return None
    inside = (parts == int(np.argmax(votes))) & has_depth & ~edge
    averaged, _ = patch.averaged(patch.depth, inside)
    return Segment(inside, patch.pixels[inside], patch.directions[inside], averaged[inside], lowest)


def _heights(ground: Ground, directions: Floats, depth: Floats) -> Floats:
    return np.asarray(depth * (directions @ ground.normal) + ground.height)


def _spread(heights: Floats) -> float:
    """Return the standard deviation of heights of which less than half are of rocks, by their median deviation."""
    return 1.4826 * float(np.median(np.abs(heights - np.median(heights)))) if heights.size else 0.0
