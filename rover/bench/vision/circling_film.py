"""Rendered film of a camera that drives around a circle before the landmarks of the demo, for pictures and tests."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np
from roverkit.demo.field import AHEAD, HEIGHT_M, LENS, SIDE, landmarks
from roverkit.vision import Pose, TargetId
from roverkit.vision.camera.camera_model import Floats
from roverkit.vision.frames import Frame
from roverkit.vision.images.rendering import Pose as PrintPose
from roverkit.vision.images.rendering import Print, marker_print, render, texture
from roverkit.vision.markers.detection import Image

FRAMES = 16
"""Number of images in one trip around the circle."""
RATE_HZ = 10.0
"""Images per second."""
FOLDER = {"source": "frames", "rate": RATE_HZ}
"""Keys of a file of cameras for the images in a folder beside it."""


@dataclass(frozen=True, slots=True, eq=False)
class Film:
    """Images of a camera that drives in a circle, with the camera's true pose in each image."""

    frames: tuple[Image, ...]
    truth: tuple[Pose, ...]
    """Pose of the camera (camera to field) in each image."""

    def __iter__(self) -> Iterator[Frame]:
        for number, image in enumerate(self.frames):
            yield Frame(image, round(number * 1e9 / RATE_HZ), number)


def rover_position(camera: Pose) -> Floats:
    """Return the position (3,) in metres of the rover, given the pose of its camera (camera to field)."""
    position: Floats = camera.translation - np.array([0, 0, HEIGHT_M])
    return position


def render_film(frames: int = FRAMES) -> Film:
    """Render the first ``frames`` images that the camera sees on its trip around the circle.

    Two calls give the same images.
    """
    rng = np.random.default_rng(1)
    scene, known = texture(LENS.size, rng), landmarks().places
    truth = tuple(_place(2 * np.pi * index / FRAMES) for index in range(frames))
    drawn = [
        render(LENS, scene, [_print(number, one.pose, place) for number, one in known.items()], rng) for place in truth
    ]
    return Film(tuple(np.repeat(image[:, :, None], 3, axis=2) for image in drawn), truth)


def _place(angle: float) -> Pose:
    """Return the pose of the camera (camera to field) when the rover is at ``angle``, in radians, on its circle."""
    return Pose(AHEAD, np.array([0.3 * np.sin(angle), 0.3 * np.cos(angle), HEIGHT_M]))


def _print(number: TargetId, landmark: Pose, camera: Pose) -> tuple[Print, PrintPose]:
    """Return the printed marker of a landmark, and its pose in the camera's frame; both poses are on the field."""
    seen = camera.inverse() @ landmark
    return marker_print(cv2.aruco.DICT_5X5_250, int(number), SIDE, texels=8), PrintPose(seen.rotation, seen.translation)
