"""Camera model: a pinhole camera with lens distortion, as in OpenCV's `projectPoints` and `fisheye`.

A *ray* is a direction in the camera's optical frame (x right, y down, z forward: REP 103). It is given by the point (x,
y) in which it meets the plane z = 1. Integer pixel coordinates are the centres of pixels.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roverlink.runtime.core.errors import SetupError

Floats = NDArray[np.floating[Any]]

_NAMES = ["k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6", "s1", "s2", "s3", "s4", "tx", "ty"]
_MODELS = {0: "no distortion"} | {count: " ".join(_NAMES[:count]) for count in (4, 5, 8, 12, 14)}
_FISHEYE = 4
_NEWTON_STEPS = 20
_ROUNDING = 1e-6
_CONVERGED = 1e-10  # in the plane z = 1; less than a millionth of a pixel


@dataclass(frozen=True, slots=True, eq=False)
class CameraParameters:
    """Intrinsic parameters of a camera; the methods convert rays to pixels and back.

    `matrix` is the 3x3 camera matrix in pixels. `distortion` has 0, 4, 5, 8, 12 or 14 coefficients in OpenCV's order,
    or the 4 of OpenCV's fisheye model if `fisheye` is true. `size` is (width, height) of the images of the calibration,
    if known. `covariance` is that of fx fy cx cy, or of these and all coefficients, if known. Raises
    `SetupError` for impossible values.
    """

    matrix: Floats
    distortion: Floats
    size: tuple[int, int] | None = None
    fisheye: bool = False
    covariance: Floats | None = None

    def __post_init__(self) -> None:
        matrix = np.asarray(self.matrix, dtype=float)
        distortion = np.asarray(self.distortion, dtype=float).ravel()
        if matrix.shape != (3, 3) or not np.isfinite(matrix).all() or min(matrix[0, 0], matrix[1, 1]) <= 0:
            raise SetupError(f"the camera matrix is {matrix.tolist()}; it must be 3x3 with positive focal lengths")
        if not np.isfinite(distortion).all():
            raise SetupError(f"the distortion is {distortion.tolist()}; its coefficients must be finite numbers")
        if distortion.size != _FISHEYE if self.fisheye else distortion.size not in _MODELS:
            known = "k1 k2 k3 k4" if self.fisheye else "; ".join(_MODELS.values())
            raise SetupError(f"the distortion has {distortion.size} coefficients; known models: {known}")
        if self.covariance is not None and not _is_covariance(self.covariance, (4, 4 + distortion.size)):
            raise SetupError(
                "the camera parameters have an impossible covariance; it must be a symmetric matrix without negative "
                f"variances, for fx fy cx cy (4x4) or for all {4 + distortion.size} parameters"
            )
        object.__setattr__(self, "matrix", matrix)
        object.__setattr__(self, "distortion", distortion)

    @property
    def focal(self) -> Floats:
        """Focal lengths (fx, fy) in pixels."""
        focal: Floats = self.matrix[[0, 1], [0, 1]]
        return focal

    @property
    def centre(self) -> Floats:
        """Principal point (cx, cy) in pixels."""
        return self.matrix[:2, 2]

    def distort(self, rays: Floats) -> Floats:
        """Return the pixels (..., 2) at which the camera sees rays (..., 2).

        A ray is given by its point (x, y) in the plane z = 1.
        """
        pixels: Floats = self._bend(rays)[0] * self.focal + self.centre
        return pixels

    def undistort(self, pixels: Floats) -> Floats:
        """Return the rays (..., 2) that the camera sees at pixels (..., 2), by Newton's method on `distort`.

        A ray is given by its point (x, y) in the plane z = 1. It is NaN for a pixel to which no ray leads; such pixels
        are far outside the calibrated area.
        """
        # cv2.undistortPoints makes five steps of a fixed-point iteration by default, which converges slowly where a
        # lens bends much: with k1 -0.35 and k2 0.12, the ray (0.8, 0.45) is still wrong by 0.8 px at a focal length of
        # 1165.
        wanted: Floats = (np.asarray(pixels, dtype=float) - self.centre) / self.focal
        rays: Floats = wanted.copy()
        for _ in range(_NEWTON_STEPS):
            bent, slope = self._bend(rays)
            miss = wanted - bent
            if np.abs(miss).max(initial=0) < _CONVERGED:
                break
            # Cramer's rule for all 2x2 systems at once.
            determinant = slope[..., 0, 0] * slope[..., 1, 1] - slope[..., 0, 1] * slope[..., 1, 0]
            step_x = slope[..., 1, 1] * miss[..., 0] - slope[..., 0, 1] * miss[..., 1]
            step_y = slope[..., 0, 0] * miss[..., 1] - slope[..., 1, 0] * miss[..., 0]
            with np.errstate(all="ignore"):
                rays = rays + np.stack([step_x, step_y], axis=-1) / determinant[..., None]
        else:
            rays[~(np.abs(wanted - self._bend(rays)[0]).max(axis=-1) < _CONVERGED)] = np.nan
        return rays

    def distort_with_derivative(self, rays: Floats) -> tuple[Floats, Floats]:
        """Return the pixels (..., 2) of rays, as `distort` does, and the derivative (..., 2, 2) of the pixels.

        The derivative is with respect to the rays (x, y).
        """
        bent, slope = self._bend(rays)
        return bent * self.focal + self.centre, slope * self.focal[:, None]

    def project(self, points: Floats) -> Floats:
        """Return the pixels (..., 2) of points (..., 3) in the optical frame, in metres; NaN behind the camera."""
        points = np.asarray(points, dtype=float)
        depth = np.where(points[..., 2:] > 0, points[..., 2:], np.nan)
        return self.distort(points[..., :2] / depth)

    def scaled(self, size: tuple[int, int]) -> CameraParameters:
        """Return the camera for images that were resized to (width, height).

        Resizing scales the areas of pixels, but coordinates count from the centre of the first pixel. So c + 0.5 is
        scaled, not the coordinate c itself. Raises `SetupError` if `size` of this camera is None.
        """
        if self.size is None:
            raise SetupError("the camera parameters name no image size, so they cannot be scaled; calibrate again")
        factor = np.array(size) / self.size
        matrix = self.matrix.copy()
        matrix[:2] *= factor[:, None]
        # (c + 0.5) * factor - 0.5, of which c * factor is done already.
        matrix[:2, 2] += (factor - 1) / 2
        covariance = self.covariance
        if covariance is not None:
            each = np.append(np.tile(factor, 2), np.ones(len(covariance) - 4))
            covariance = covariance * each * each[:, None]
        return CameraParameters(matrix, self.distortion, size, self.fisheye, covariance)

    def _bend(self, rays: Floats) -> tuple[Floats, Floats]:
        """Return the distorted rays (..., 2) of rays, and their derivative (..., 2, 2) with respect to the rays."""
        return _bend_fisheye(rays, self.distortion) if self.fisheye else _bend(rays, self.distortion)


def _is_covariance(matrix: Floats, sizes: tuple[int, int]) -> bool:
    """Return true if a matrix of one of the `sizes` is a covariance; rounding errors are allowed."""
    if matrix.ndim != 2 or len(matrix) not in sizes or matrix.shape[1] != len(matrix) or not np.isfinite(matrix).all():
        return False
    variances: Floats = matrix.diagonal()
    sigmas = np.sqrt(np.where(variances > 0, variances, 1.0))
    scaled = matrix / sigmas / sigmas[:, None]
    smallest = float(np.min(np.linalg.eigvalsh(scaled)))
    return bool(np.abs(scaled - scaled.T).max() < _ROUNDING) and smallest > -_ROUNDING


def _bend(rays: Floats, coefficients: Floats) -> tuple[Floats, Floats]:
    """Return the distorted rays (..., 2) by OpenCV's rational model, and their derivative (..., 2, 2).

    The derivative is with respect to the rays. The model is a quotient of polynomials in r^2 = x^2 + y^2, with
    tangential distortion by Brown and Conrady, thin prism distortion (s1 to s4), and a sensor that is tilted (tx, ty).
    """
    given: list[float] = coefficients.tolist()
    k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4, tx, ty = given + [0.0] * (len(_NAMES) - len(given))
    x, y = rays[..., 0], rays[..., 1]
    xx, yy, xy = x * x, y * y, x * y
    r2 = xx + yy
    radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
    # 2 d radial / d r^2; the factor 2 comes from d r^2 / dx = 2 x
    growth = 2 * k1 + r2 * (4 * k2 + 6 * k3 * r2)
    if k4 or k5 or k6:
        below = 1 + r2 * (k4 + r2 * (k5 + r2 * k6))
        radial = radial / below
        growth = (growth - radial * (2 * k4 + r2 * (4 * k5 + 6 * k6 * r2))) / below
    bent, slope = np.empty((*np.shape(x), 2)), np.empty((*np.shape(x), 2, 2))
    bent[..., 0] = x * radial + 2 * p1 * xy + p2 * (r2 + 2 * xx)
    bent[..., 1] = y * radial + p1 * (r2 + 2 * yy) + 2 * p2 * xy
    slope[..., 0, 0] = radial + xx * growth + 2 * p1 * y + 6 * p2 * x
    slope[..., 1, 1] = radial + yy * growth + 6 * p1 * y + 2 * p2 * x
    slope[..., 0, 1] = slope[..., 1, 0] = xy * growth + 2 * p1 * x + 2 * p2 * y
    if s1 or s2 or s3 or s4:
        linear, square = np.array([s1, s3]), np.array([s2, s4])
        r2 = r2[..., None]
        bent += r2 * (linear + r2 * square)
        slope += (2 * (linear + 2 * r2 * square))[..., None] * rays[..., None, :]
    return _tilt(bent, slope, tx, ty) if tx or ty else (bent, slope)


def _tilt(bent: Floats, slope: Floats, tx: float, ty: float) -> tuple[Floats, Floats]:
    """Return distorted rays (..., 2) and their derivative (..., 2, 2), projected onto a tilted image sensor.

    The sensor is turned by `tx` about its x axis and then by `ty` about its y axis, in radians, as in OpenCV.
    """
    sin_x, cos_x, sin_y, cos_y = math.sin(tx), math.cos(tx), math.sin(ty), math.cos(ty)
    turn = np.array(
        [
            [cos_y, sin_y * sin_x, -sin_y * cos_x],
            [0, cos_x, sin_x],
            [sin_y, -cos_y * sin_x, cos_y * cos_x],
        ]
    )
    # Along the optical axis onto the plane z = 1 again, with the centre of the image where it was.
    onto = np.array([[turn[2, 2], 0, -turn[0, 2]], [0, turn[2, 2], -turn[1, 2]], [0, 0, 1]]) @ turn
    above, below = bent @ onto[:2, :2].T + onto[:2, 2], bent @ onto[2, :2] + onto[2, 2]
    tilted = above / below[..., None]
    by_bent = (onto[:2, :2] - tilted[..., None] * onto[2, :2]) / below[..., None, None]
    return tilted, by_bent @ slope


def _bend_fisheye(rays: Floats, coefficients: Floats) -> tuple[Floats, Floats]:
    """Return the distorted rays (..., 2) by OpenCV's fisheye model, and their derivative (..., 2, 2).

    The derivative is with respect to the rays. The model (Kannala and Brandt, 2006) is a polynomial in the angle
    between the ray and the optical axis.
    """
    k1, k2, k3, k4 = coefficients
    r = np.maximum(np.hypot(rays[..., 0], rays[..., 1]), 1e-12)
    angle = np.arctan(r)
    a2 = angle * angle
    radial = angle * (1 + a2 * (k1 + a2 * (k2 + a2 * (k3 + a2 * k4)))) / r
    by_angle = 1 + a2 * (3 * k1 + a2 * (5 * k2 + a2 * (7 * k3 + a2 * 9 * k4)))
    growth = (by_angle / (1 + r * r) - radial) / (r * r)
    slope = rays[..., :, None] * rays[..., None, :] * growth[..., None, None]
    slope = slope + np.eye(2) * radial[..., None, None]
    return rays * radial[..., None], slope
