"""Scene of the demo's camera: four landmarks (ArUco markers at known poses) on a field.

The images of the scene are rendered, so the camera's true pose is known in each image.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import yaml

from roverlink.vision import CameraParameters, Landmark, Landmarks, Pose
from roverlink.vision.camera.camera_model import Floats
from roverlink.vision.camera.parameters_file import write_parameters
from roverlink.vision.frames import Frame
from roverlink.vision.images.rendering import Lens, Print, marker_print, render, texture
from roverlink.vision.images.rendering import Pose as PrintPose
from roverlink.vision.markers.detection import Image
from roverlink.vision.opencv import cv2

FRAMES = 16
"""Number of images in one trip of the rover around its circle."""
RATE_HZ = 10.0
"""Images per second."""
SIDE = 0.15
"""Side of the markers in metres."""
SURVEY = 0.002
"""Standard deviation of the landmarks' measured positions in metres. For their rotations, the default is used."""
HEIGHT_M = 0.6
"""Height of the camera on the rover in metres."""
_SIZE = (640, 480)
LENS = Lens(
    np.array([[600.0, 0, 322.5], [0, 602.0, 236.0], [0, 0, 1]]),
    (0.100096, -0.256227, 0.00111085, 0.000269882, 0),
    _SIZE,
)
"""Lens of the simulated camera."""
_FACING_US = np.array(
    [[0.0, 0, -1], [-1, 0, 0], [0, 1, 0]]
)  # the print's axes in the field: right is -y, up is z, towards the viewer is -x
AHEAD = np.array([[0.0, 0, 1], [-1, 0, 0], [0, -1, 0]])
"""Rotation (camera to rover) of a camera that looks along x."""
_LANDMARKS = {7: (3.0, 0.9, 0.9), 8: (3.4, 0.2, 1.2), 9: (2.6, -0.5, 0.5), 10: (3.2, -1.0, 1.0)}


@dataclass(frozen=True, slots=True, eq=False)
class Film:
    """Images of a camera that drives in a circle, with the camera's true pose in each image."""

    frames: tuple[Image, ...]
    truth: tuple[Pose, ...]
    """Pose of the camera (camera to field) in each image."""

    def __iter__(self) -> Iterator[Frame]:
        for number, image in enumerate(self.frames):
            yield Frame(image, round(number * 1e9 / RATE_HZ), number)


def landmarks() -> Landmarks:
    """Return the four landmarks, with their poses in the frame ``map``."""
    return Landmarks("map", {number: Landmark(_on_field(number), SURVEY) for number in _LANDMARKS})


def parameters() -> CameraParameters:
    """Return the camera matrix, the distortion and the image size of the simulated camera."""
    return CameraParameters(LENS.matrix, np.array(LENS.distortion), _SIZE)


def write_field(folder: Path) -> None:
    """Write the camera's parameters to ``camera.yml`` and the landmarks to ``landmarks.yaml``, both in ``folder``."""
    write_parameters(folder / "camera.yml", parameters())
    lines = [
        f"  {number}: {{position: {one.pose.translation.tolist()}, rpy: [90, 0, -90]}}"
        for number, one in landmarks().places.items()
    ]
    text = "\n".join(["frame: map", f"survey: {{position: {SURVEY}}}", "landmarks:", *lines, ""])
    (folder / "landmarks.yaml").write_text(text, encoding="utf-8")


def write_cameras(folder: Path, source: str = "frames") -> None:
    """Write ``cameras.yaml``: the simulated camera, with a source beside the file: a folder of images, or a video."""
    keys = {
        "source": source,
        **({} if Path(source).suffix else {"rate": RATE_HZ}),
        "parameters": "camera.yml",
        "mount": {"position": [0, 0, HEIGHT_M], "rpy": [0, 0, 0]},
    }
    text = yaml.safe_dump({"cameras": {"front": keys}}, sort_keys=False, default_flow_style=None)
    (folder / "cameras.yaml").write_text(text, encoding="utf-8")


def rover_position(camera: Pose) -> Floats:
    """Return the position (3,) in metres of the rover, given the pose of its camera (camera to field)."""
    position: Floats = camera.translation - np.array([0, 0, HEIGHT_M])
    return position


def render_film(frames: int = FRAMES) -> Film:
    """Render the first ``frames`` images that the camera of the demo's rover sees on its trip around a circle.

    Two calls give the same images.
    """
    rng = np.random.default_rng(1)
    scene = texture(_SIZE, rng)
    truth = tuple(_place(2 * np.pi * index / FRAMES) for index in range(frames))
    drawn = [render(LENS, scene, [_print(number, place) for number in _LANDMARKS], rng) for place in truth]
    return Film(tuple(np.repeat(image[:, :, None], 3, axis=2) for image in drawn), truth)


def _on_field(number: int) -> Pose:
    return Pose(_FACING_US, np.array(_LANDMARKS[number]))


def _place(angle: float) -> Pose:
    """Return the pose of the camera (camera to field) when the rover is at ``angle``, in radians, on its circle."""
    return Pose(AHEAD, np.array([0.3 * np.sin(angle), 0.3 * np.cos(angle), HEIGHT_M]))


def _print(number: int, camera: Pose) -> tuple[Print, PrintPose]:
    """Return the printed marker of a landmark, and its pose in the camera's frame; ``camera`` is the camera's pose."""
    seen = camera.inverse() @ _on_field(number)
    return marker_print(cv2.aruco.DICT_5X5_250, number, SIDE, texels=8), PrintPose(seen.rotation, seen.translation)
