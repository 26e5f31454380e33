"""What ``roverlink aruco track`` publishes about landmarks, without images: corners with noise.

The corners have the errors that the covariances of the tracker allow for: noise in each image, and for each seed one
error of the markers' side and one of the camera's focal length. The poses and covariances are the tracker's own.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import yaml
from roverkit.driving.arcs import PlanarPose
from roverkit.vision import CameraParameters, Landmark, LandmarkDetection, Landmarks, Pose, TargetId
from roverkit.vision.camera.uncertainty import Uncertainty, camera_roots, pixels_by_camera, pixels_to_rays
from roverkit.vision.markers.marker_set import square
from roverkit.vision.poses.pnp import Corners, solve, square_poses, with_all_errors
from roverkit.vision.poses.pose import predict, quaternion_of, rotation_of
from roverkit.vision.ros.landmark_messages import FrameNames, detections_of

from roverlink.runtime.interfaces import vision_msgs

MOUNT = Pose(np.array([[0.0, 0, 1], [-1, 0, 0], [0, -1, 0]]), np.array([0.3, 0.0, 0.5]))
"""Camera that looks ahead (optical frame to base_link)."""
FRAME = "front_optical_frame"
_SIDE = 0.2
_FOCAL = 600.0
_SIZE = (640, 480)
_CALIBRATED_PX = (1.0, 1.0, 0.5, 0.5)  # standard deviations of fx, fy, cx and cy
_MATRIX = np.array([[_FOCAL, 0, 320], [0, _FOCAL, 240], [0, 0, 1]])
_CAMERA = CameraParameters(_MATRIX, np.zeros(5), _SIZE, covariance=np.diag([*_CALIBRATED_PX, *[1e-6] * 5]) ** 2)
_UNCERTAINTY = Uncertainty(side_sigma=0.002)
_NOISE_PX = 0.05  # of each corner, by the noise of the image
_SMALLEST_PX = 20.0
_STEEPEST = math.cos(math.radians(70))
_INWARDS = np.array([[0.0, 0, -1], [-1, 0, 0], [0, 1, 0]])  # right is -y, up is z, towards the viewer is -x


def field(*, half: float = 3.0) -> Landmarks:
    """Four landmarks in the corners of a square, which face its middle."""
    places = {}
    for number, angle in enumerate((45, 135, 225, 315), 7):
        turn = rotation_of(np.array([0, 0, math.radians(angle)]))
        position = np.array([half * np.sign(turn[0, 0]), half * np.sign(turn[1, 0]), 0.6])
        places[number] = Landmark(Pose(turn @ _INWARDS, position), 0.005, math.radians(0.25))
    return Landmarks("map", places)


def write_field(folder: Path, camera: str) -> tuple[Path, Path]:
    """Write the landmarks and the camera with a name into files of a folder, and return their paths."""
    mount = {"position": MOUNT.translation.tolist(), "rpy": [0, 0, 0]}
    landmarks, cameras = folder / "landmarks.yaml", folder / "cameras.yaml"
    places = {
        number: {
            "position": one.pose.translation.tolist(),
            "orientation": quaternion_of(one.pose.rotation).tolist(),
            "survey": {"position": one.position_sigma, "rotation": math.degrees(one.rotation_sigma)},
        }
        for number, one in field().places.items()
    }
    landmarks.write_text(yaml.safe_dump({"frame": "map", "landmarks": places}), encoding="utf-8")
    cameras.write_text(yaml.safe_dump({"cameras": {camera: {"source": "0", "mount": mount}}}), encoding="utf-8")
    return landmarks, cameras


def standing(landmarks: Landmarks, seed: int, moved: Mapping[TargetId, tuple[float, float]]) -> dict[TargetId, Pose]:
    """Where landmarks really stand: beside the survey by its accuracy, and those that somebody has moved in metres."""
    rng = np.random.default_rng([seed, 1])
    places = {}
    for name, one in landmarks.places.items():
        error = np.concatenate([rng.normal(0, one.position_sigma, 3), rng.normal(0, one.rotation_sigma, 3)])
        error[:2] += moved.get(name, (0, 0))
        places[name] = one.pose.moved(error)
    return places


class SimulatedTracker:
    """Camera of a rover on a plane."""

    mount = MOUNT

    def __init__(self, seed: int, places: Mapping[TargetId, Pose]) -> None:
        self._rng = np.random.default_rng([seed, 2])
        self._places = dict(places)
        self._side = _SIDE * (1 + self._rng.normal(0, _UNCERTAINTY.side_sigma))
        focal_x, focal_y, x, y = self._rng.normal(0, _CALIBRATED_PX) / _FOCAL
        self._scale, self._centre = 1 + np.array([focal_x, focal_y]), np.array([x, y])
        self._roots = camera_roots(_CAMERA)

    def move(self, name: TargetId, x: float, y: float) -> None:
        """Move a landmark by some metres on the field."""
        place = self._places[name]
        self._places[name] = Pose(place.rotation, place.translation + np.array([x, y, 0]))

    def see(self, rover: PlanarPose, stamp: int) -> vision_msgs.Detection3DArray:
        """Return the message about an image that is taken at a pose of the rover."""
        base = Pose(rotation_of(np.array([0, 0, rover.yaw])), np.array([rover.x, rover.y, 0]))
        camera = (base @ MOUNT).inverse()
        found = [self._detection(name, camera @ place, stamp) for name, place in self._places.items()]
        return detections_of([one for one in found if one is not None], stamp, FrameNames(FRAME, "aruco_"))

    def _detection(self, name: TargetId, place: Pose, stamp: int) -> LandmarkDetection | None:
        if place.translation[2] <= 0:
            return None
        rays, _ = predict(place, square(self._side))
        pixels = rays * _FOCAL + _CAMERA.matrix[:2, 2]
        toward = -place.translation / np.linalg.norm(place.translation)
        if (
            (pixels < 5).any()
            or (pixels > np.array(_SIZE) - 5).any()
            or np.linalg.norm(pixels[0] - pixels[1]) < _SMALLEST_PX
            or toward @ place.rotation[:, 2] < _STEEPEST
        ):
            return None
        deviation = math.hypot(_NOISE_PX, _UNCERTAINTY.corner_floor) / _FOCAL
        rays = rays * self._scale + self._centre + self._rng.normal(0, deviation, rays.shape)
        shifts = pixels_to_rays(_CAMERA, rays, pixels_by_camera(_CAMERA, self._roots, rays))
        points = square(_SIDE)
        seen = Corners(
            points,
            rays,
            np.eye(8) * (_NOISE_PX / _FOCAL) ** 2,
            np.eye(8) * (_UNCERTAINTY.corner_floor / _FOCAL) ** 2,
            shifts,
        )
        (solutions,) = solve([seen], square_poses(points[None], rays[None]))
        # Of the two poses, the tracker decides for the true one over several images.
        solutions = sorted(solutions, key=lambda one: one.pose.angle_to(place))
        ((seen, solutions),) = with_all_errors([seen], [solutions[:1]], _UNCERTAINTY.side_sigma)
        best = solutions[0]
        return LandmarkDetection(name, stamp, pixels, best.pose, best.covariance, math.inf, 0.0, seen, tuple(solutions))
