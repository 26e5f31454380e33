"""Camera programs: they find ArUco markers, and compute the poses of markers and of the camera.

`Tracker` finds markers in images and estimates their poses. `localize` computes the camera's pose on a field from the
markers whose poses on the field are known. Importing this package without OpenCV raises `SetupError`, which says how to
install OpenCV.
"""

from roverkit.vision.opencv import cv2 as _cv2  # noqa: F401  # first: it explains how to install OpenCV and numpy

# isort: split

from roverkit.vision.camera.camera_model import CameraParameters
from roverkit.vision.camera.parameters_file import read_parameters, write_parameters
from roverkit.vision.localization.landmarks import Landmark, Landmarks, read_landmarks
from roverkit.vision.localization.pose_from_landmarks import FieldPose, localize
from roverkit.vision.markers.marker_set import Board, MarkerSet, TargetId
from roverkit.vision.markers.tracker import LandmarkDetection, Tracker
from roverkit.vision.poses.pose import Pose

__all__ = [
    "Board",
    "CameraParameters",
    "FieldPose",
    "Landmark",
    "Landmarks",
    "MarkerSet",
    "Pose",
    "LandmarkDetection",
    "TargetId",
    "Tracker",
    "localize",
    "read_landmarks",
    "read_parameters",
    "write_parameters",
]
