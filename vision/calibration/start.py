"""A rough camera, and where boards are before it: enough to judge a view, and to start the solver."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from roverlink.vision.calibration.board import CharucoBoard
from roverlink.vision.calibration.views import FEWEST_CORNERS, View
from roverlink.vision.camera.camera_model import CameraParameters, Floats
from roverlink.vision.opencv import cv2
from roverlink.vision.poses.pose import Pose, predict, rotation_of

FOCALS = np.geomspace(0.4, 4.0, 13)
"""Focal lengths to try, in widths of the image: fields of view from 103 to 14 degrees."""
GUESS = 1.0
"""That of a camera about which no view tells anything."""
_SOME = 6
"""Views that are enough to tell such focal lengths apart."""


def ideal_camera(focal: float, size: tuple[int, int], *, fisheye: bool = False) -> CameraParameters:
    """A camera without distortion that looks through the middle of its image; the focal length is in pixels."""
    width, height = size
    matrix = np.array([[focal, 0, (width - 1) / 2], [0, focal, (height - 1) / 2], [0, 0, 1]])
    return CameraParameters(matrix, np.zeros(4), size, fisheye)


def rough_camera(views: Sequence[View], board: CharucoBoard, *, fisheye: bool = False) -> CameraParameters:
    """The ideal camera, of those with `FOCALS`, that fits views best; of a single view, the one with `GUESS`."""
    size = views[0].size
    if len(views) < 2:  # one view fits nearly any focal length
        return ideal_camera(GUESS * size[0], size, fisheye=fisheye)
    some = views[:: -(-len(views) // _SOME)]
    cameras = [ideal_camera(focal * size[0], size, fisheye=fisheye) for focal in FOCALS]
    return min(cameras, key=lambda camera: float(np.median([rough_pose(view, board, camera)[1] for view in some])))


def rough_pose(view: View, board: CharucoBoard, camera: CameraParameters) -> tuple[Pose, float]:
    """Where a board is (board to camera), and the median distance of its corners from their projections in pixels.

    IPPE (Collins and Bartoli, 2014), by OpenCV; the better of its two solutions. The distance is infinite where the
    camera cannot have seen the view.
    """
    rays = camera.undistort(view.corners)
    met = np.isfinite(rays).all(axis=1)
    if met.sum() < FEWEST_CORNERS:
        return Pose(np.eye(3), np.array([0, 0, 1.0])), math.inf
    _, turns, shifts, _ = cv2.solvePnPGeneric(
        board.points[view.ids[met]], rays[met, None], np.eye(3), None, flags=cv2.SOLVEPNP_IPPE
    )
    poses = [Pose(rotation_of(np.ravel(turn)), np.ravel(shift)) for turn, shift in zip(turns, shifts)]
    misses = [np.linalg.norm(residuals(view, board, camera, pose), axis=1) for pose in poses]
    medians = [float(np.median(np.nan_to_num(miss, nan=math.inf))) for miss in misses]
    best = int(np.argmin(medians))
    return poses[best], medians[best]


def residuals(view: View, board: CharucoBoard, camera: CameraParameters, pose: Pose) -> Floats:
    """From where a view's corners should be to where they are seen (N, 2), in pixels."""
    rays, _ = predict(pose, board.points[view.ids])
    return view.corners - camera.distort(rays)
