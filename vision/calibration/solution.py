"""What a calibration hands back: the camera, how sure it is, and what became of each view."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from roverlink.runtime.core.errors import RoverlinkError
from roverlink.vision.calibration.adjustment import by_parameters
from roverlink.vision.calibration.views import View
from roverlink.vision.camera.camera_model import CameraParameters, Floats
from roverlink.vision.poses.pose import Pose, predict


class Model(str, Enum):
    """Which distortion is estimated, by the names that ROS has for them."""

    PLUMB_BOB = "plumb_bob"
    """k1 k2 p1 p2 k3: the default."""
    RATIONAL = "rational_polynomial"
    """k1 k2 p1 p2 k3 k4 k5 k6: wide lenses."""
    EQUIDISTANT = "equidistant"
    """OpenCV's fisheye, k1 k2 k3 k4."""


COEFFICIENTS = {
    Model.PLUMB_BOB: ("k1", "k2", "p1", "p2", "k3"),
    Model.RATIONAL: ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"),
    Model.EQUIDISTANT: ("k1", "k2", "k3", "k4"),
}

_NORMAL_QUANTILE = 1.96  # 97.5 %
_GRID = 15


class PoorViewsError(RoverlinkError):
    """The views do not determine the camera: too few, or of too little. `reasons` say what to do about it."""

    def __init__(self, reasons: tuple[str, ...]) -> None:
        super().__init__("; ".join(reasons))
        self.reasons = reasons


@dataclass(frozen=True, slots=True, eq=False)
class Fitted:
    """One view after the calibration."""

    view: View
    pose: Pose
    """Board to camera."""
    residuals: Floats
    """(N, 2) pixels, from where the corners should be to where they were seen; of dropped ones, too."""
    used: NDArray[np.bool_]
    """(N,) which corners the calibration rests on; none of a dropped view."""
    dropped: str = ""
    """Why the view was left out; empty if it was not."""

    @property
    def rms(self) -> float:
        """Root of the mean squared length of the residuals in pixels: of the used corners, or all of a dropped view.

        Nan of a view without corners.
        """
        chosen = self.residuals[self.used] if self.used.any() else self.residuals
        return float(np.sqrt((chosen**2).sum(axis=1).mean())) if chosen.size else math.nan

    @property
    def rejected(self) -> int:
        """How many corners of a view that is used were left out."""
        return 0 if self.dropped else int((~self.used).sum())


@dataclass(frozen=True, slots=True, eq=False)
class Calibration:
    """A camera, and how well it is known."""

    camera: CameraParameters
    model: Model
    covariance: Floats
    """(P, P) of the parameters: fx fy cx cy in pixels, then the distortion's coefficients."""
    rms: float
    """Root of the mean squared length of the residuals of all corners that are used, in pixels."""
    views: tuple[Fitted, ...]
    """In the order in which they were given, the dropped ones included."""

    @property
    def names(self) -> tuple[str, ...]:
        """What the parameters are called."""
        return ("fx", "fy", "cx", "cy", *COEFFICIENTS[self.model])

    @property
    def values(self) -> Floats:
        """The parameters (P,)."""
        return np.concatenate([self.camera.focal, self.camera.centre, self.camera.distortion])

    @property
    def deviations(self) -> Floats:
        """Standard deviations (P,) of the parameters."""
        return np.sqrt(self.covariance.diagonal())

    @property
    def interval(self) -> float:
        """How many standard deviations to each side of a parameter hold the truth in 95 % of calibrations."""
        return _NORMAL_QUANTILE

    def uncertainty(self, pixels: Floats) -> Floats:
        """Standard deviation (...,) in pixels, over both axes, of where the rays of pixels (..., 2) are seen.

        What a turn of the camera explains over the whole image is taken out first: turned cameras are used as well as
        straight ones. Nan where no ray meets a pixel.
        """
        everywhere = self._rays(self._grid())
        everywhere = everywhere[np.isfinite(everywhere).all(axis=1)]
        by_turn, by_camera = _by_turn(self.camera, everywhere), by_parameters(self.camera, everywhere)
        turn = -np.linalg.lstsq(by_turn.reshape(-1, 3), by_camera.reshape(by_turn.size // 3, -1), rcond=None)[0]
        rays = self._rays(pixels)
        derivative = by_parameters(self.camera, rays) + _by_turn(self.camera, rays) @ turn
        variance: Floats = np.einsum("nip,pq,niq->n", derivative, self.covariance, derivative)
        return np.sqrt(variance).reshape(np.shape(pixels)[:-1])

    def _rays(self, pixels: Floats) -> Floats:
        return self.camera.undistort(np.reshape(pixels, (-1, 2)))

    def _grid(self) -> Floats:
        width, height = self.views[0].view.size
        return np.stack(np.meshgrid(np.linspace(0, width - 1, _GRID), np.linspace(0, height - 1, _GRID)), axis=-1)


def _by_turn(camera: CameraParameters, rays: Floats) -> Floats:
    """The derivative (N, 2, 3) of the pixels that rays (N, 2) meet by a small turn of the rays."""
    _, by_pose = predict(Pose(np.eye(3), np.zeros(3)), np.column_stack([rays, np.ones(len(rays))]))
    derivative: Floats = camera.distort_with_slope(rays)[1] @ by_pose[:, :, 3:]
    return derivative
