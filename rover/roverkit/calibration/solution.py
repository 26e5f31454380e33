"""Result of a calibration: the camera's parameters, their uncertainty, and the result of each view."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from roverkit.calibration.board_shape import NUMBERS
from roverkit.calibration.verdict import Judgement
from roverkit.calibration.views import View
from roverkit.vision.camera.camera_model import CameraParameters, Floats
from roverkit.vision.camera.parameter_derivatives import by_parameters
from roverkit.vision.poses.pose import Pose, predict
from roverlink.runtime.core.errors import RoverlinkError


class Model(str, Enum):
    """Distortion model of a lens, with the names that ROS uses (sensor_msgs/distortion_models.hpp)."""

    PLUMB_BOB = "plumb_bob"
    """k1 k2 p1 p2 k3; the default."""
    RATIONAL = "rational_polynomial"
    """k1 k2 p1 p2 k3 k4 k5 k6; for wide lenses."""
    EQUIDISTANT = "equidistant"
    """k1 k2 k3 k4; OpenCV's fisheye model."""


COEFFICIENTS = {
    Model.PLUMB_BOB: ("k1", "k2", "p1", "p2", "k3"),
    Model.RATIONAL: ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"),
    Model.EQUIDISTANT: ("k1", "k2", "k3", "k4"),
}

_NORMAL_QUANTILE = 1.96  # 97.5 % quantile of the normal distribution: 2.5 % are outside on each side
_ENOUGH = 500  # corners that determine a rotation


class PoorViewsError(RoverlinkError):
    """Error: the views do not determine the camera's parameters. Each of the `reasons` is a message for the user."""

    def __init__(self, reasons: tuple[str, ...]) -> None:
        super().__init__("; ".join(reasons))
        self.reasons = reasons


@dataclass(frozen=True, slots=True, eq=False)
class Fitted:
    """View (the board corners of one image) with its results: the board's pose, the residuals, and the corners used."""

    view: View
    pose: Pose
    """Pose of the board (board to camera)."""
    residuals: Floats
    """Residuals (N, 2) of all corners in pixels: observed minus expected position; NaN for an unusable view."""
    used: NDArray[np.bool_]
    """Mask (N,) of the corners that the calibration uses; all false for a dropped view."""
    dropped: str = ""
    """Reason why the view was left out; empty if it is used."""

    @property
    def rms(self) -> float:
        """Root mean square of the lengths of the residuals, in pixels.

        It is computed from the corners that were used, or from all corners of a view that was left out. NaN for a view
        without corners.
        """
        chosen = self.residuals[self.used] if self.used.any() else self.residuals
        return float(np.sqrt((chosen**2).sum(axis=1).mean())) if chosen.size else math.nan

    @property
    def rejected(self) -> int:
        """Number of corners that were left out of the view, if the view itself was used."""
        return 0 if self.dropped else int((~self.used).sum())


@dataclass(frozen=True, slots=True, eq=False)
class Calibration:
    """Camera parameters with their uncertainty, and the result of each view."""

    camera: CameraParameters
    model: Model
    covariance: Floats
    """Covariance (P, P) of the parameters: fx fy cx cy in pixels, then the distortion coefficients."""
    rms: float
    """Root mean square of the residuals' lengths over all used corners, in pixels."""
    views: tuple[Fitted, ...]
    """All views in the order given, including dropped ones."""
    shape: Floats = field(default_factory=lambda: np.zeros(NUMBERS))
    """Shape (4,) of the board, see `board_shape`."""
    shape_covariance: Floats = field(default_factory=lambda: np.zeros((NUMBERS, NUMBERS)))
    """Covariance (4, 4) of the shape."""
    judgement: Judgement = field(default_factory=Judgement)
    """Verdict on the calibration, with its reasons."""

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the camera's parameters, in the order of `values`."""
        return ("fx", "fy", "cx", "cy", *COEFFICIENTS[self.model])

    @property
    def values(self) -> Floats:
        """Values (P,) of the camera's parameters."""
        return np.concatenate([self.camera.focal, self.camera.centre, self.camera.distortion])

    @property
    def deviations(self) -> Floats:
        """Standard deviations (P,) of the camera's parameters."""
        return np.sqrt(self.covariance.diagonal())

    @property
    def interval(self) -> float:
        """Factor that converts a standard deviation to half the width of its 95 % confidence interval."""
        return _NORMAL_QUANTILE

    @property
    def seen(self) -> Floats:
        """Positions (N, 2) in pixels of all corners that the calibration uses."""
        return np.concatenate([fitted.view.corners[fitted.used] for fitted in self.views])

    def uncertainty(self, pixels: Floats) -> Floats:
        """Return how exactly the calibration is known at `pixels` (..., 2): a standard deviation (...,) in pixels.

        Each pixel belongs to a direction in space. The result is the uncertainty of the pixel at which the camera model
        places this direction: the root of the summed variances along both axes. Errors that are equal to a rotation of
        the camera are removed first, because such a rotation has no effect in use. NaN if no direction belongs to a
        pixel.
        """
        # The rotation is that of the directions in which corners were seen. Outside them, a model may say anything.
        everywhere = self._rays(self.seen[:: -(-len(self.seen) // _ENOUGH)])
        everywhere = everywhere[np.isfinite(everywhere).all(axis=1)]
        by_turn, by_camera = _by_turn(self.camera, everywhere), by_parameters(self.camera, everywhere)
        turn = -np.linalg.lstsq(by_turn.reshape(-1, 3), by_camera.reshape(by_turn.size // 3, -1), rcond=None)[0]
        rays = self._rays(pixels)
        derivative = by_parameters(self.camera, rays) + _by_turn(self.camera, rays) @ turn
        variance: Floats = np.einsum("nip,pq,niq->n", derivative, self.covariance, derivative)
        return np.sqrt(variance).reshape(np.shape(pixels)[:-1])

    def _rays(self, pixels: Floats) -> Floats:
        return self.camera.undistort(np.reshape(pixels, (-1, 2)))


def _by_turn(camera: CameraParameters, rays: Floats) -> Floats:
    """Return the derivative (N, 2, 3) of the pixels of rays (N, 2) with respect to rotations about x, y and z."""
    _, by_pose = predict(Pose(np.eye(3), np.zeros(3)), np.column_stack([rays, np.ones(len(rays))]))
    derivative: Floats = camera.distort_with_derivative(rays)[1] @ by_pose[:, :, 3:]
    return derivative
