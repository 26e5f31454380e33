"""Homographies of markers: maps from a marker's square, whose sides go from -1 to 1, to pixels or rays."""

from __future__ import annotations

import numpy as np

from roverkit.vision.camera.camera_model import Floats

SQUARE = np.array([[-1.0, 1, 1, -1], [-1.0, -1, 1, 1]])
"""Corners u and v (2, 4) of a marker, v down, in OpenCV's order."""
LIFTED = np.vstack([SQUARE, np.ones(4)])
"""Corners (3, 4) of `SQUARE` in homogeneous coordinates."""
_SHARES = np.vstack([LIFTED, SQUARE[0] * SQUARE[1]]).T / 4
"""Shares (4, 4) of the corners in the coefficients of u, v, 1 and uv of the bilinear map to them."""


def homographies(points: Floats) -> Floats:
    """Return the homographies (K, 3, 3) that map the corners of `SQUARE` to points (K, 2, 4).

    Their last element is 1. They are not finite, or have no inverse, if three of the points lie on one line.
    """
    # Corners have u^2 = v^2 = 1. So (1 + g u + h v) times the bilinear map is linear there if g and h cancel uv.
    u, v, middle, uv = np.moveaxis(points @ _SHARES, 2, 0)
    with np.errstate(all="ignore"):
        g, h = (_cross(uv, u) / _cross(u, v))[:, None], (_cross(v, uv) / _cross(u, v))[:, None]
        columns = u + g * middle + h * uv, v + h * middle + g * uv, middle + g * u + h * v
    last = g, h, np.ones_like(g)
    return np.stack([np.concatenate(parts, axis=1) for parts in zip(columns, last)], axis=2)


def apply(homography: Floats, points: Floats) -> Floats:
    """Map points (K, 2, N) by homographies (K, 3, 3)."""
    lifted = homography[:, :, :2] @ points + homography[:, :, 2:]
    images: Floats = lifted[:, :2] / lifted[:, 2:]
    return images


def apply_with_derivative(homography: Floats, points: Floats) -> tuple[Floats, Floats]:
    """Map points (K, 2, N) by homographies (K, 3, 3).

    Returns the mapped points (K, 2, N), and their derivative (K, 2, 2, N) with respect to the given points.
    """
    lifted = homography[:, :, :2] @ points + homography[:, :, 2:]
    images = lifted[:, :2] / lifted[:, 2:]
    slope = homography[:, :2, :2, None] - images[:, :, None] * homography[:, 2, None, :2, None]
    return images, slope / lifted[:, 2, None, None]


def _cross(vectors: Floats, others: Floats) -> Floats:
    """Return the cross products (K,) of vectors (K, 2) in a plane."""
    products: Floats = vectors[:, 0] * others[:, 1] - vectors[:, 1] * others[:, 0]
    return products
