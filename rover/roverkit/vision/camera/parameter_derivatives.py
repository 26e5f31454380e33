"""Derivatives of pixels with respect to the parameters of a camera."""

from __future__ import annotations

import numpy as np

from roverkit.vision.camera.camera_model import CameraParameters, Floats


def by_parameters(camera: CameraParameters, rays: Floats) -> Floats:
    """Return the derivative (N, 2, P) of the pixels of `rays` (N, 2) with respect to the camera's parameters.

    The order of the parameters is fx fy cx cy, then the distortion coefficients. Known models are the fisheye
    model, and those with 5 or 8 coefficients. A ray is a point in the plane z = 1.
    """
    by_distortion = _by_fisheye if camera.fisheye else _by_rational
    of_distortion = by_distortion(rays, camera.distortion) * camera.focal[:, None]
    return np.concatenate([by_pinhole(camera, rays), of_distortion], axis=2)


def by_pinhole(camera: CameraParameters, rays: Floats) -> Floats:
    """Return the derivative (N, 2, 4) of the pixels of `rays` (N, 2) with respect to fx fy cx cy."""
    bent = (camera.distort(rays) - camera.centre) / camera.focal
    derivative = np.zeros((len(rays), 2, 4))
    derivative[:, 0, 0], derivative[:, 1, 1] = bent.T
    derivative[:, 0, 2] = derivative[:, 1, 3] = 1
    return derivative


def _by_rational(rays: Floats, coefficients: Floats) -> Floats:
    """Return the derivative (N, 2, C) of the distorted rays with respect to the C distortion coefficients.

    The model is OpenCV's rational one. The order of the coefficients is k1 k2 p1 p2 k3 k4 k5 k6.
    """
    x, y = rays.T
    r2 = x * x + y * y
    powers = np.stack([r2, r2**2, r2**3])
    k1, k2, _, _, k3, *below = coefficients
    under = 1 + np.array(below) @ powers if below else np.ones_like(r2)
    quotient = (1 + np.array([k1, k2, k3]) @ powers) / under
    above = powers / under
    tangential = np.stack([[2 * x * y, r2 + 2 * y * y], [r2 + 2 * x * x, 2 * x * y]])  # by p1, by p2
    radial = above[:, None] * rays.T
    parts = [radial[0], radial[1], tangential[0], tangential[1], radial[2]]
    parts += list(-quotient * radial) if below else []
    derivative: Floats = np.stack(parts, axis=-1).transpose(1, 0, 2)
    return derivative


def _by_fisheye(rays: Floats, coefficients: Floats) -> Floats:
    """Return the derivative (N, 2, 4) of the distorted rays with respect to the fisheye coefficients k1 k2 k3 k4."""
    # In the centre of the image, angle / r is 1 as a limit.
    r = np.maximum(np.hypot(*rays.T), 1e-12)
    angle = np.arctan(r)
    powers = angle[:, None] ** (3 + 2 * np.arange(coefficients.size)) / r[:, None]
    derivative: Floats = rays[:, :, None] * powers[:, None]
    return derivative
