"""Camera of the demo's rover: it sees landmarks, and ``roverlink aruco track`` computes the rover's position."""

from __future__ import annotations

import roverkit.vision  # noqa: F401  # first: it explains how to install numpy and OpenCV

# isort: split

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from roverkit.aruco.rover_position_publisher import position_publisher
from roverkit.aruco.tracker_declaration import POSITION
from roverkit.demo.camera_program import CameraProgram
from roverkit.demo.demo_rover import DemoRover
from roverkit.demo.driven_path import Point
from roverkit.demo.field import SIDE, landmarks, write_cameras, write_field
from roverkit.demo.rover_images import RoverImages
from roverkit.vision.camera.camera_model import Floats
from roverlink.numerals import counted
from roverlink.runtime.middleware import Middleware
from roverlink.simulation.demo_parts import DemoSetting
from roverlink.topic_types import full_topic

_TRACKER = "tracker"


class MarkerCamera(CameraProgram):
    """Camera on the rover, before a field with landmarks."""

    rows = (POSITION.row,)

    def __init__(self, setting: DemoSetting, rover: DemoRover, images: RoverImages) -> None:
        """Write the files for the child process, and prepare its command line."""
        self.images, self._driven = images, rover.driven
        self._driven.landmarks = {
            str(name): _on_map(landmark.pose.translation) for name, landmark in landmarks().places.items()
        }
        self._publish_position: Callable[[Floats], None] = lambda _: None
        self._frames = 0
        self._worst = 0.0
        super().__init__(setting, "markers")

    def _words(self, folder: Path) -> Sequence[str]:
        write_field(folder)
        write_cameras(folder, {"source": self.images.url(_TRACKER)})
        known = str(folder / "landmarks.yaml")
        return ["aruco", "track", str(folder / "cameras.yaml"), "--side", str(SIDE), "--landmarks", known]

    def _publish_on(self, middleware: Middleware) -> None:
        self._publish_position = position_publisher(middleware, self._setting.registry, full_topic)

    @property
    def result(self) -> str:
        """Number of images, and the largest error of the position."""
        known = counted(len(self._driven.landmarks), "landmark")
        return (
            f"the camera of the rover located the rover in {counted(self._frames, 'frame')} with {known}; "
            f"largest error {1e3 * self._worst:.0f} mm"
        )

    def _take(self, view: dict[str, Any]) -> None:
        if "position" not in view.get("rover", {}):
            return
        place = np.array(view["rover"]["position"])
        self._publish_position(place)
        pose = self.images.sent(_TRACKER).pose(view["frame"], view["stamp"])
        self._driven.camera.add(_on_map(place), (pose.x, pose.y))
        self._worst = max(self._worst, float(np.linalg.norm(place - (pose.x, pose.y, 0.0))))
        self._frames += 1


def _on_map(position: Floats) -> Point:
    return float(position[0]), float(position[1])
