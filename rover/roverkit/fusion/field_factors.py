"""Factors of the graph between states of the rover and landmarks, and their derivatives.

A state is a vector (5,): x, y and yaw on the field, and the errors of the odometry (`slipping_motion`). It is one
variable, because the versions of GTSAM for Python 3.10 give no joint covariance of two variables.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from roverkit.driving.arcs import PlanarPose
from roverkit.fusion.gtsam_library import gtsam
from roverkit.fusion.planar_gaussian import Floats, rotation
from roverkit.fusion.slipping_motion import STATES, SlippingMotion

_POSE, _ERRORS = slice(0, 3), slice(3, STATES)
_FLOOR = np.diag([1e-3] * STATES) ** 2
"""Least covariance of a motion: a millimetre and a milliradian. GTSAM cannot invert that of an exact motion."""


def motion_factor(start: int, end: int, motion: SlippingMotion) -> Any:
    """Return the factor of a motion between two states."""
    expected = pose2(motion.pose)

    def error(_: Any, values: Any, derivatives: Any) -> Floats:
        before, after = values.atVector(start), values.atVector(end)
        missed, by_before, by_after = _missed(expected, gtsam.Pose2(*before[_POSE]), gtsam.Pose2(*after[_POSE]))
        if derivatives is not None:
            by_start, by_end = np.zeros((STATES, STATES)), np.eye(STATES)
            by_start[_POSE, _POSE] = by_before @ rotation(before[2]).T
            by_start[_POSE, _ERRORS] = -motion.by_errors
            by_start[_ERRORS, _ERRORS] = -np.diag(motion.kept)
            by_end[_POSE, _POSE] = by_after @ rotation(after[2]).T
            derivatives[0], derivatives[1] = by_start, by_end
        errors = before[_ERRORS]
        return np.concatenate([missed - motion.by_errors @ errors, after[_ERRORS] - motion.kept * errors])

    return gtsam.CustomFactor(gtsam.noiseModel.Gaussian.Covariance(motion.covariance + _FLOOR), [start, end], error)


def detection_factor(key: int, landmark: int, place: PlanarPose, noise: Any) -> Any:
    """Return the factor of a landmark with a place in the frame of the rover."""
    expected = pose2(place)

    def error(_: Any, values: Any, derivatives: Any) -> Floats:
        state = values.atVector(key)
        missed, by_rover, by_landmark = _missed(expected, gtsam.Pose2(*state[_POSE]), values.atPose2(landmark))
        if derivatives is not None:
            by_state = np.zeros((3, STATES))
            by_state[:, _POSE] = by_rover @ rotation(state[2]).T
            derivatives[0], derivatives[1] = by_state, by_landmark
        return missed

    return gtsam.CustomFactor(noise, [key, landmark], error)


def state_factor(key: int, first: int, expected: Floats, noise: Any) -> Any:
    """Return the factor of components of a state that are known, from the ``first`` one."""
    part = slice(first, first + len(expected))

    def error(_: Any, values: Any, derivatives: Any) -> Floats:
        if derivatives is not None:
            derivatives[0] = np.eye(STATES)[part]
        missed: Floats = values.atVector(key)[part] - expected
        return missed

    return gtsam.CustomFactor(noise, [key], error)


def pose2(pose: PlanarPose) -> Any:
    """Return a pose as one of GTSAM."""
    return gtsam.Pose2(pose.x, pose.y, pose.yaw)


def _missed(expected: Any, pose: Any, other: Any) -> tuple[Floats, Floats, Floats]:
    """Return the error (3,) of the pose of ``other`` in the frame of ``pose``, and its derivatives (3, 3) by both.

    The derivatives hold for any error, also for that of a direction that nobody has measured.
    """
    apart = pose.between(other)
    error = expected.between(apart)
    turned = rotation(error.theta())
    return np.array([error.x(), error.y(), error.theta()]), -turned @ apart.inverse().AdjointMap(), turned
