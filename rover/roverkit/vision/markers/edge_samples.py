"""Selection of the pixels near the edges of a marker's pattern. The edge fit compares these pixels with a model.

A module is one black or white cell of a marker; u and v are coordinates along its sides. The shape (K, ..., N) means K
markers with up to N pixels each; the rows of markers with fewer pixels are padded.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roverkit.vision.camera.camera_model import CameraParameters, Floats
from roverkit.vision.markers.pattern import Pattern
from roverkit.vision.poses.homography import apply_with_derivative

ACROSS = (-1.0, 0.0, 1.0)
"""Distances from an edge, in pixels, at which pixels are taken."""
CLEAR = 2.2
"""Smallest distance in pixels between a pixel that is used and the outer limit of the marker's white border.

The white border is at least one module wide. A module is one black or white cell of the marker.
"""


@dataclass(frozen=True, slots=True, eq=False)
class MarkerBatch:
    """K markers to fit, as arrays of M points on edges; the rows of markers with fewer points are padded."""

    differences: Floats
    """Mixed differences (K, n, n) of the patterns, as in `Pattern`."""
    places: Floats
    """Points (K, 2, M) on the edges: u and v in modules (cells of the marker)."""
    across_u: NDArray[np.bool_]
    """Mask (K, M) of the points whose edge is crossed along u; the other edges are crossed along v."""
    real: NDArray[np.bool_]
    """Mask (K, M) of the real points; false for padding."""
    half: float
    """Half the number of modules of a side."""
    centre: Floats
    """Mean (K, 2) of the rays of a marker's corners; a ray is a point in the plane z = 1."""
    scale: Floats
    """Extent (K,) of the rays of a marker's corners. The fit works with scaled rays: (ray - `centre`) / `scale`."""

    def only(self, chosen: NDArray[np.intp]) -> MarkerBatch:
        """Return a batch with only some of the markers."""
        if len(chosen) == len(self.scale):
            return self
        return MarkerBatch(
            self.differences[chosen],
            self.places[chosen],
            self.across_u[chosen],
            self.real[chosen],
            self.half,
            self.centre[chosen],
            self.scale[chosen],
        )


@dataclass(frozen=True, slots=True, eq=False)
class Pixels:
    """Pixels near the edges that were selected for each of K markers, up to N for each, in single precision."""

    grey: Floats
    """Grey values (K, N); 0 for padding."""
    points: Floats
    """Scaled rays (K, 2, N) of the pixels, as `MarkerBatch` defines them."""
    by_pixel: Floats
    """Derivative (K, 2, 2, N) of `points` with respect to the coordinates of the pixels."""
    real: Floats
    """Weights (K, N): 1, or 0 for padding."""

    def every(self, stride: int) -> Pixels:
        """Return a selection with only every `stride`-th pixel."""
        return Pixels(*(part[..., ::stride].copy() for part in (self.grey, self.points, self.by_pixel, self.real)))

    def only(self, chosen: NDArray[np.intp]) -> Pixels:
        """Return a selection with the pixels of only some markers."""
        if len(chosen) == len(self.grey):
            return self
        return Pixels(*(part[chosen] for part in (self.grey, self.points, self.by_pixel, self.real)))


def make_batch(patterns: Sequence[Pattern], rays: Floats) -> MarkerBatch:
    """Return K markers as arrays, given their patterns and the rays (K, 4, 2) of their approximate corners."""
    most = max(pattern.across_u.size for pattern in patterns)
    places = np.zeros((len(patterns), 2, most))
    across_u, real = np.zeros((2, len(patterns), most), dtype=bool)
    for k, pattern in enumerate(patterns):
        count = pattern.across_u.size
        places[k, :, :count], across_u[k, :count], real[k, :count] = pattern.places, pattern.across_u, True
    centre = rays.mean(axis=1)
    return MarkerBatch(
        differences=np.stack([pattern.differences for pattern in patterns]),
        places=places,
        across_u=across_u,
        real=real,
        half=patterns[0].modules / 2,
        centre=centre,
        scale=np.abs(rays - centre[:, None]).max(axis=(1, 2)),
    )


def _inverse(matrices: Floats) -> Floats:
    """Return the inverses of 2x2 matrices (K, 2, 2, N)."""
    a, b, c, d = matrices[:, 0, 0], matrices[:, 0, 1], matrices[:, 1, 0], matrices[:, 1, 1]
    # Written out: numpy.linalg.inv loops over the matrices, and takes 15 times as long for 2x2.
    swapped: Floats = np.stack([d, -b, -c, a], axis=1).reshape(matrices.shape)
    return swapped / (a * d - b * c)[:, None, None]


def product(left: Floats, right: Floats) -> Floats:
    """Return the products of 2x2 matrices (K, 2, 2, N)."""
    return left[:, :, :1] * right[:, :1] + left[:, :, 1:] * right[:, 1:]


def _turned(matrices: Floats, vectors: Floats) -> Floats:
    """Return the products of 2x2 matrices (K, 2, 2, N) and vectors (K, 2, M, N)."""
    return matrices[:, :, :1] * vectors[:, None, 0] + matrices[:, :, 1:] * vectors[:, None, 1]


def choose_pixels(image: NDArray[np.uint8], camera: CameraParameters, batch: MarkerBatch, homography: Floats) -> Pixels:
    """Select the pixels along the edges of each marker's pattern.

    `homography` (K, 3, 3) maps `SQUARE` to the scaled rays at which each marker is expected. Only points on the edges
    are undistorted, because undistorting each pixel would be slow. The ray of a pixel follows from the nearest point on
    an edge and the derivative of the undistortion at this point.
    """
    points, by_square = apply_with_derivative(homography, batch.places / batch.half - 1)
    rays = points * batch.scale[:, None, None] + batch.centre[:, :, None]
    seen, slope = camera.distort_with_derivative(rays.transpose(0, 2, 1))
    seen, by_pixel = seen.transpose(0, 2, 1), _inverse(np.moveaxis(slope, 1, -1)) / batch.scale[:, None, None, None]
    modules_by_pixel = product(_inverse(by_square) * batch.half, by_pixel).astype(np.float32)
    modules_a_pixel = np.sqrt((modules_by_pixel**2).sum(axis=2))
    normal = modules_by_pixel / modules_a_pixel[:, :, None]
    normal = np.where(batch.across_u[:, None], normal[:, 0], normal[:, 1])
    places = np.rint(seen[:, :, None] + np.array(ACROSS)[:, None] * normal[:, :, None])  # (K, 2, offsets, M)
    moved, by_pixel = (places - seen[:, :, None]).astype(np.float32), by_pixel.astype(np.float32)
    middle = (batch.places - batch.half).astype(np.float32)
    off = np.abs(middle[:, :, None] + _turned(modules_by_pixel, moved))
    limit = np.maximum(0, 1 - CLEAR * modules_a_pixel) + batch.half
    height, width = image.shape
    x, y = places[:, 0], places[:, 1]
    usable = (off <= limit[:, :, None]).all(axis=1) & batch.real[:, None]
    usable &= (x >= 0) & (y >= 0) & (x < width) & (y < height)
    places = np.where(usable[:, None], places, 0).astype(np.int32).reshape(len(places), 2, -1)
    distinct = _first_uses(places, usable.reshape(len(places), -1))
    count = distinct.sum(axis=1)
    most = max(int(np.max(count, initial=0)), 1)
    real = np.arange(most) < count[:, None]
    # Neighbours in the order are at different distances from an edge, so `Pixels.every` takes pixels of all kinds.
    edges, offsets = seen.shape[2], len(ACROSS)
    in_order = distinct.reshape(-1, offsets, edges).swapaxes(1, 2).reshape(distinct.shape)
    order = np.argsort(~in_order, axis=1, kind="stable")[:, :most]
    # padding is at the first point, so that its blur in modules is that of the others
    chosen = np.where(real, order % offsets * edges + order // offsets, 0)
    moved_points = (points.astype(np.float32)[:, :, None] + _turned(by_pixel, moved)).reshape(len(chosen), 2, -1)
    return Pixels(
        image.ravel()[_picked(places[:, 1] * width + places[:, 0], chosen)] * real.astype(np.float32),
        _picked(moved_points, chosen),
        _picked(by_pixel, chosen % edges),
        real.astype(np.float32),
    )


def _picked(values: NDArray[Any], chosen: NDArray[np.intp]) -> NDArray[Any]:
    """Return the values (K, ..., N) at some places (K, N) of values (K, ..., M)."""
    # numpy.take_along_axis takes several times as long.
    rows = np.moveaxis(values, 0, -2)
    flat = chosen + np.arange(len(chosen))[:, None] * values.shape[-1]
    return np.moveaxis(rows.reshape(*rows.shape[:-2], -1).take(flat, axis=-1), -2, 0)


def _first_uses(places: NDArray[np.int32], usable: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return a mask (K, P) of the usable ones of P pixels (K, 2, P) of each marker, without those that came before."""
    high = np.where(usable[:, None], places, -1).max(axis=2)
    low = np.where(usable[:, None], places, high[:, :, None]).min(axis=2)
    # A pixel's position in the box around the marker; the boxes of all markers follow each other.
    width, height = (high - low + 1).T
    end = np.cumsum(width * height)
    column, row = (places - low[:, :, None]).swapaxes(0, 1)
    inside = (end - width * height)[:, None] + row * width[:, None] + column
    position = np.where(usable, inside, end[-1]).ravel()
    first, order = np.empty(end[-1] + 1, np.intp), np.arange(position.size)
    first[position[::-1]] = order[::-1]  # the last value stays
    distinct: NDArray[np.bool_] = usable & (first[position] == order).reshape(usable.shape)
    return distinct
