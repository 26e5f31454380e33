"""Rough parameters of a camera and rough poses of a board: good enough to judge a view and to start the solver."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from roverkit.calibration.board import CalibrationBoard
from roverkit.calibration.views import FEWEST_CORNERS, View
from roverkit.vision.camera.camera_model import CameraParameters, Floats
from roverkit.vision.opencv import cv2
from roverkit.vision.poses.pose import Pose, predict, rotation_of

FOCALS = np.geomspace(0.4, 4.0, 13)
"""Focal lengths that `rough_camera` tries, in image widths: horizontal fields of view from 103 to 14 degrees."""
GUESS = 1.0
"""Focal length, in image widths, that `rough_camera` assumes for a single view, which does not determine it."""
_SOME = 6
"""Largest number of views that `rough_camera` compares; so many are enough to choose one of `FOCALS`."""


def ideal_camera(focal: float, size: tuple[int, int], *, fisheye: bool = False) -> CameraParameters:
    """Return a camera without distortion whose principal point is the image's centre; `focal` is in pixels.

    `size` is (width, height) of the image.
    """
    width, height = size
    matrix = np.array([[focal, 0, (width - 1) / 2], [0, focal, (height - 1) / 2], [0, 0, 1]])
    return CameraParameters(matrix, np.zeros(4), size, fisheye)


def rough_camera(views: Sequence[View], board: CalibrationBoard, *, fisheye: bool = False) -> CameraParameters:
    """Return the camera without distortion that fits the views best, among those with the focal lengths `FOCALS`.

    For a single view, return the camera with the focal length `GUESS`.
    """
    size = views[0].size
    # With one view, a longer focal length and a larger distance look the same.
    if len(views) < 2:  # one view fits nearly any focal length
        return ideal_camera(GUESS * size[0], size, fisheye=fisheye)
    some = views[:: -(-len(views) // _SOME)]
    cameras = [ideal_camera(focal * size[0], size, fisheye=fisheye) for focal in FOCALS]
    return min(cameras, key=lambda camera: float(np.median([rough_pose(view, board, camera)[1] for view in some])))


def rough_pose(view: View, board: CalibrationBoard, camera: CameraParameters) -> tuple[Pose, float]:
    """Return the pose of the board in a view (board to camera), and the median reprojection error in pixels.

    Uses IPPE (Collins and Bartoli, 2014) from OpenCV and selects the better one of the two solutions. The error is
    infinite if this camera cannot have seen the view.
    """
    nowhere = Pose(np.eye(3), np.array([0, 0, 1.0])), math.inf
    rays = camera.undistort(view.corners)
    met = np.isfinite(rays).all(axis=1)
    if met.sum() < FEWEST_CORNERS:
        return nowhere
    # Rays with a unit camera matrix: the lens was removed before, whatever its model.
    _, turns, shifts, _ = cv2.solvePnPGeneric(
        board.points[view.ids[met]], rays[met, None], np.eye(3), None, flags=cv2.SOLVEPNP_IPPE
    )
    if not turns:  # IPPE finds no pose if the rays are far from those of a plane
        return nowhere
    poses = [Pose(rotation_of(np.ravel(turn)), np.ravel(shift)) for turn, shift in zip(turns, shifts)]
    misses = [np.linalg.norm(residuals(view, board.points, camera, pose), axis=1) for pose in poses]
    medians = [float(np.median(np.nan_to_num(miss, nan=math.inf))) for miss in misses]
    best = int(np.argmin(medians))
    return poses[best], medians[best]


def residuals(view: View, points: Floats, camera: CameraParameters, pose: Pose) -> Floats:
    """Return the residuals (N, 2) of a view's corners in pixels: observed position minus expected position.

    `points` are all corners of the board, flat or bent.
    """
    rays, _ = predict(pose, points[view.ids])
    return view.corners - camera.distort(rays)
