"""Scene of the demo's camera: four landmarks (ArUco markers at known poses) on a field."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import yaml

from roverkit.vision import CameraParameters, Landmark, Landmarks, Pose
from roverkit.vision.camera.parameters_file import write_parameters
from roverkit.vision.images.rendering import Lens

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
        f"  {number}: {{position: {landmark.pose.translation.tolist()}, rpy: [90, 0, -90]}}"
        for number, landmark in landmarks().places.items()
    ]
    text = "\n".join(["frame: map", f"survey: {{position: {SURVEY}}}", "landmarks:", *lines, ""])
    (folder / "landmarks.yaml").write_text(text, encoding="utf-8")


def write_cameras(folder: Path, source: Mapping[str, object]) -> None:
    """Write ``cameras.yaml``: the simulated camera, with the keys that describe its source."""
    keys = {**source, "parameters": "camera.yml", "mount": {"position": [0, 0, HEIGHT_M], "rpy": [0, 0, 0]}}
    text = yaml.safe_dump({"cameras": {"front": keys}}, sort_keys=False, default_flow_style=None)
    (folder / "cameras.yaml").write_text(text, encoding="utf-8")


def _on_field(number: int) -> Pose:
    return Pose(_FACING_US, np.array(_LANDMARKS[number]))
