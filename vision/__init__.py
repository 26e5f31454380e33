"""Cameras: where markers are, and where that puts the camera.

`Tracker` finds markers in images and estimates their poses; `localize` puts those together on a field whose landmarks
are known. Importing this without OpenCV raises `SetupError`, which says how to install it.
"""

from vision._opencv import cv2 as _cv2  # noqa: F401  # first: it says what is missing, numpy included
from vision.camera import CameraParameters
from vision.landmarks import Landmark, Landmarks, read_landmarks
from vision.localization import FieldPose, localize
from vision.markers import Board, MarkerSet, TargetId
from vision.parameters import read_parameters, write_parameters
from vision.pose import Pose
from vision.tracking import Sighting, Tracker

__all__ = [
    "Board",
    "CameraParameters",
    "FieldPose",
    "Landmark",
    "Landmarks",
    "MarkerSet",
    "Pose",
    "Sighting",
    "TargetId",
    "Tracker",
    "localize",
    "read_landmarks",
    "read_parameters",
    "write_parameters",
]
