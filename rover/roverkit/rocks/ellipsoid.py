"""Fit of an ellipsoid on the ground to a depth image.

The line across a rock gives the ellipsoid's ends: they are on the rays of the line's endpoints, at the height at which
the rock is widest. Four numbers are unknown: half the width and half the height as fractions of half the length, the
height of the widest part as a fraction of the line's length, and the distance of the middle from the line as a fraction
of half the length. They are those for which the computed depth of ellipsoid and ground is nearest to the measured one.

No rock is an ellipsoid. So the differences are weighted robustly, their standard deviation contains the irregularity of
rocks, and the four numbers have a prior: without it, a rock with few pixels would be fitted to the noise.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from roverkit.rocks.ground import NOISE
from roverkit.vision.camera.camera_model import Floats

_IRREGULARITY = 0.02
"""Standard deviation of a rock's surface from an ellipsoid, as a fraction of half the length."""
_INDEPENDENT = 400
"""Number of independent differences, at most: neighbouring pixels share their noise and the rock's irregularity."""
_ROBUST = 2.0
"""Standard deviations from which differences count less and less (Cauchy's weights)."""
_EXPECTED = np.array([np.log(0.75), np.log(0.6), 0.0, 0.0])
_SPREAD = np.array([0.35, 0.5, 0.125, 0.08])
"""Prior: logarithms of width and height, height of the widest part, and distance of the middle from the line."""
_STARTS = np.array([[np.log(0.75), np.log(0.5), 0, 0], [np.log(0.75), np.log(0.5), 0.15, 0], [np.log(0.6), -1.4, 0, 0]])
_HIGHEST = 0.4
"""Highest widest part, as a fraction of the line's length: a ball on the ground has 0.5, if nothing of it is buried."""
_BETTER = 0.95
"""Part of the cost of the bare ground that an ellipsoid may have: bumps of a rough ground have more."""
_MOST_SQUARED = 9.0  # three standard deviations: flying pixels at the edges have many
_STEPS = 20
_STEP = 1e-3
_CONVERGED = 1e-4


@dataclass(frozen=True, slots=True, eq=False)
class EllipsoidPatch:
    """Part of a depth image around a line, in the frame of the line on the ground.

    The origin is the line's first end on the ground; x is along the line, z is up.
    """

    length: float
    """Length of the line on the ground in metres."""
    camera: Floats
    """Position (3,) of the camera."""
    directions: Floats
    """Directions (N, 3) of the pixels' rays: camera + depth * direction is the point that a pixel shows."""
    inverse: Floats
    """Inverse depths (N,) of the pixels in 1/m."""

    def sizes(self, shape: Floats) -> tuple[Floats, Floats]:
        """Return the semi-axes (3,) and the centre (3,) of an ellipsoid in metres; ``shape`` is the four numbers."""
        # At the height z, the rays of the endpoints are nearer to the camera by this share of their way.
        nearer = shape[2] * self.length / self.camera[2]
        half = (1 - nearer) * self.length / 2
        axes = half * np.array([1.0, np.exp(shape[0]), np.exp(shape[1])])
        centre = nearer * self.camera + (half, shape[3] * half, 0)
        return axes, centre

    def predicted(self, shape: Floats | None) -> Floats:
        """Return the inverse depths (N,) of an ellipsoid on the ground, or of the bare ground."""
        ground: Floats = np.maximum(-self.directions[:, 2], 0) / self.camera[2]
        if shape is None:
            return ground
        axes, centre = self.sizes(shape)
        origin, ways = (self.camera - centre) / axes, self.directions / axes
        squares, middles = (ways**2).sum(axis=1), ways @ origin
        under_root = middles**2 - squares * (origin @ origin - 1)
        # 1 / depth of the nearer one of both points.
        nearer = np.where(under_root > 0, -middles + np.sqrt(np.maximum(under_root, 0)), 0) / (origin @ origin - 1)
        predicted: Floats = np.maximum(ground, nearer)
        return predicted

    @property
    def sigma(self) -> Floats:
        """Standard deviations (N,) of the inverse depths: of the noise and of the irregularity of rocks together."""
        return np.asarray(np.hypot(NOISE, _IRREGULARITY * self.length / 2 * self.inverse**2))

    def differences(self, shape: Floats | None) -> Floats:
        """Return the differences (N,) of measured and computed inverse depths in standard deviations."""
        return np.asarray((self.inverse - self.predicted(shape)) / self.sigma)

    def cost(self, shape: Floats | None) -> float:
        """Return twice the negative logarithm of the likelihood of a shape and its prior, up to a constant."""
        squares = _ROBUST**2 * np.log1p((self.differences(shape) / _ROBUST) ** 2)
        prior = 0.0 if shape is None else float((((shape - _EXPECTED) / _SPREAD) ** 2).sum())
        return self.weight * float(squares.sum()) + prior

    @property
    def weight(self) -> float:
        """Weight of a difference."""
        return min(1.0, _INDEPENDENT / max(len(self.inverse), 1))


@dataclass(frozen=True, slots=True)
class Ellipsoid:
    """Ellipsoid on the ground: its length and width in metres, and how well it explains the depth."""

    length: float
    width: float
    unlike: float
    """Standard deviation of the rock's surface from an ellipsoid beyond the irregularity that is assumed, divided by
    that irregularity. At least what the noise may hide: far from the camera, no shape can be told from another."""


def fit_ellipsoid(patch: EllipsoidPatch) -> Ellipsoid | None:
    """Return the ellipsoid that explains the depth best; None if the bare ground explains it nearly as well."""
    cost, shape = min((_descended(patch, start) for start in _STARTS), key=lambda found: found[0])
    if cost >= _BETTER * patch.cost(None):
        return None
    (half_length, half_width, _), _ = patch.sizes(shape)
    rock = patch.predicted(shape) > patch.predicted(None)
    if not rock.any():
        return None
    squares = np.minimum(patch.differences(shape)[rock] ** 2, _MOST_SQUARED)
    hidden = math.sqrt(2 / min(len(squares), _INDEPENDENT))  # standard deviation of a mean of squares
    share = 1 - float(np.mean((NOISE / patch.sigma[rock]) ** 2))
    unlike = math.sqrt(max(float(squares.mean()) - 1, hidden) / share)
    return Ellipsoid(2 * float(half_length), 2 * float(half_width), unlike)


def _descended(patch: EllipsoidPatch, shape: Floats) -> tuple[float, Floats]:
    """Return the cost of the nearest minimum and its shape (Levenberg and Marquardt)."""
    cost, damping = patch.cost(shape), 1e-2
    for _ in range(_STEPS):
        differences = patch.differences(shape)
        weights = patch.weight / (1 + (differences / _ROBUST) ** 2)
        slopes = np.stack([patch.differences(shape + _STEP * unit) - differences for unit in np.eye(4)], axis=1) / _STEP
        system = slopes.T @ (slopes * weights[:, None]) + np.diag(_SPREAD**-2)
        gradient = slopes.T @ (differences * weights) + (shape - _EXPECTED) / _SPREAD**2
        before = cost
        while cost >= before and damping < 1e6:
            tried = shape - np.linalg.solve(system + damping * np.diag(np.diag(system)), gradient)
            tried[2] = np.clip(tried[2], 0, _HIGHEST)
            found = patch.cost(tried)
            damping *= 0.25 if found < before else 4
            if found < before:
                cost, shape = found, tried
        if before - cost <= _CONVERGED * before:
            break
    return cost, shape
