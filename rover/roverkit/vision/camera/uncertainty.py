"""Uncertainty of what a camera's poses depend on beside the noise of the image."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from roverkit.vision.camera.camera_model import CameraParameters, Floats
from roverkit.vision.camera.parameter_derivatives import by_parameters, by_pinhole
from roverlink.runtime.core.errors import SetupError

UNKNOWN_CAMERA = 0.003
"""Standard deviation of the focal lengths and of the principal point, as a fraction of the focal length.

It holds for a camera whose parameters have no covariance.
"""
_SAME_FOCAL = np.array([[1.0, 0, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])  # fx and fy have the same error
_PINHOLE = 4  # fx fy cx cy
_DERIVED = (5, 8)  # numbers of coefficients for which `by_parameters` knows the derivatives


@dataclass(frozen=True, slots=True)
class Uncertainty:
    """Errors that the covariances of poses contain beside the noise of the image. Raises `SetupError` if impossible."""

    side_sigma: float = 0.005
    """Standard deviation of a marker's side, as a fraction of it. All markers are equally wrong."""
    corner_floor: float = 0.05
    """Standard deviation of each corner in pixels that no image shows: bent paper, ink, and the model of the fit."""
    covariance_scale: float = 1.0
    """Factor by which all standard deviations are multiplied."""
    readout_time: float = 0.0
    """Time in seconds from the first row of the image to the last one; 0 for a global shutter.

    Corners are moved to where they were when the middle row was read. The change of their velocity is an error.
    """

    def __post_init__(self) -> None:
        for name in ("side_sigma", "corner_floor", "readout_time"):
            if not 0 <= (value := getattr(self, name)) < math.inf:
                raise SetupError(f"{name} is {value}; it must be a finite number, at least 0")
        if not 0 < self.covariance_scale < math.inf:
            raise SetupError(f"covariance_scale is {self.covariance_scale}; it must be positive and finite")


def camera_roots(camera: CameraParameters) -> Floats:
    """Return a matrix (P, P) whose product with its transpose is the covariance of a camera's parameters.

    The parameters are fx fy cx cy, and all coefficients if their covariance is known.
    """
    covariance = camera.covariance
    if covariance is None:
        return UNKNOWN_CAMERA * math.sqrt(camera.focal[0] * camera.focal[1]) * _SAME_FOCAL
    if not camera.fisheye and camera.distortion.size not in _DERIVED:
        covariance = covariance[:_PINHOLE, :_PINHOLE]
    variances, axes = np.linalg.eigh(covariance)
    roots: Floats = axes * np.sqrt(np.maximum(variances, 0))
    return roots


def pixels_by_camera(camera: CameraParameters, roots: Floats, rays: Floats) -> Floats:
    """Return the shifts (N, 2, P) of the pixels at which rays (N, 2) are seen, by the errors of a camera's parameters.

    `roots` are those of `camera_roots`: each shift is that of one standard deviation of an independent error.
    """
    moved: Floats = -((by_pinhole if len(roots) == _PINHOLE else by_parameters)(camera, rays) @ roots)
    return moved


def pixels_to_rays(camera: CameraParameters, rays: Floats, shifts: Floats) -> Floats:
    """Convert S shifts (N, 2, S) of pixels, at which rays (N, 2) are seen, to shifts (2N, S) of the rays."""
    _, slope = camera.distort_with_derivative(rays)
    moved: Floats = np.linalg.solve(slope, shifts).reshape(2 * len(rays), -1)
    return moved
