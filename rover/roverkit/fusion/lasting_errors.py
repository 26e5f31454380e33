"""Errors of sightings that stay the same: those of the calibration, of the mount, and of the sides of markers.

A message has the covariance of a sighting. How much of it stays the same in all sightings is in no message. A part
`_LASTING` is taken to: along the way to the landmark, across it, and of its rotation, each in its own standard
deviation. The graph has the rest, `PASSING`.

These errors are not estimated, because how they act on a sighting is known too roughly. But they are in the covariance
of the pose, which many sightings would make too small otherwise (a Schmidt-Kalman filter: Schmidt, Application of
state-space methods to navigation problems, 1966). A sighting is wrong by C b by the errors b. Its gain is K, and its
derivative by the pose H. Then the derivative S of the error of the pose by b becomes (I - K H) S - K C, and S S^T is
added to the covariance of the pose.
"""

from __future__ import annotations

import math

import numpy as np

from roverkit.fusion.planar_gaussian import Floats, PlanarGaussian, adjoint, rotation

_LASTING = 0.5
"""Part of the variance of a sighting that is the same in all sightings: half, because nothing tells more or less."""
PASSING = 1 - _LASTING
UNKNOWN: Floats = 1e4 * np.eye(3)
"""Covariance of a pose before the first sighting."""


def lasting_error(place: PlanarGaussian) -> Floats:
    """Return the derivative (3, 3) of the place of a landmark, in its axes, by the errors that last.

    ``place`` is the landmark in the frame of the rover.
    """
    polar = rotation(math.atan2(place.pose.y, place.pose.x) - place.pose.yaw)
    deviations = np.sqrt(_LASTING * np.diag(polar.T @ place.covariance @ polar))
    error: Floats = polar * deviations
    return error


def sighted(pose: PlanarGaussian, lasting: Floats, place: PlanarGaussian) -> PlanarGaussian:
    """Return the place of a landmark on the field by a pose, and by its place in the frame of the rover.

    ``pose`` has the covariance without the errors that last, and ``lasting`` is its derivative by them. A landmark that
    is seen again is where it was by the last sighting, since these errors are the same.
    """
    carried = adjoint(place.pose.inverse())
    error = carried @ lasting - lasting_error(place)
    covariance = carried @ pose.covariance @ carried.T + PASSING * place.covariance + error @ error.T
    return PlanarGaussian(pose.pose @ place.pose, covariance)


def corrected(prior: Floats, lasting: Floats, by_pose: Floats, spread: Floats, error: Floats) -> tuple[Floats, Floats]:
    """Return the covariance of a pose after an input, and the derivative of its error by the errors that last.

    ``prior`` and ``lasting`` are these before the input. ``by_pose`` is the derivative of the input by the pose,
    ``spread`` the covariance of the input, and ``error`` the derivative of its error by the errors that last.
    """
    gain = np.linalg.solve(by_pose @ prior @ by_pose.T + spread, by_pose @ prior).T
    kept = np.eye(3) - gain @ by_pose
    return kept @ prior @ kept.T + gain @ spread @ gain.T, kept @ lasting - gain @ error
