"""Camera of ``roverlink demo`` that sees markers: ``roverlink aruco track`` computes the rover's position."""

from __future__ import annotations

import roverlink.vision  # noqa: F401  # first: it explains how to install numpy and OpenCV

# isort: split

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from roverlink.demo.camera_program import CameraProgram
from roverlink.demo.driven_path import DrivenPath, Point
from roverlink.demo.field import SIDE, landmarks, render_film, rover_position, write_cameras, write_field
from roverlink.runtime import Registry
from roverlink.runtime.middleware import Middleware
from roverlink.vision.camera.camera_model import Floats
from roverlink.vision.markers.detection import Image
from roverlink.vision.ros.rover_position import ROW, position_publisher


class MarkerCamera(CameraProgram):
    """Camera before a field with landmarks."""

    rows = (ROW,)

    def __init__(self, project: Path, middleware: str) -> None:
        """Render the film, write the files for the child process, and prepare its command line."""
        self._film = render_film()
        self.driven = DrivenPath({str(name): _on_map(one.pose.translation) for name, one in landmarks().places.items()})
        """True path of the rover, and the one that the child process computes."""
        self._publish_position: Callable[[Floats], None] = lambda _: None
        self._frames = 0
        self._worst = 0.0
        super().__init__(project, middleware)

    def _images(self) -> Iterable[Image]:
        return (frame.image for frame in self._film)

    def _words(self, frames: Path) -> Sequence[str]:
        folder = frames.parent
        write_field(folder)
        write_cameras(folder)
        known = str(folder / "landmarks.yaml")
        return ["aruco", "track", str(folder / "cameras.yaml"), "--side", str(SIDE), "--landmarks", known]

    def publish_on(self, middleware: Middleware, registry: Registry, topic: Callable[[str], str]) -> None:
        """Publish the positions that the child process computes."""
        self._publish_position = position_publisher(middleware, registry, topic)

    @property
    def result(self) -> str:
        """Number of images, and the largest error of the position."""
        known = len(landmarks().places)
        return (
            f"the simulated camera located the rover in {self._frames} frames with {known} landmarks; "
            f"largest error {1e3 * self._worst:.0f} mm"
        )

    def _take(self, view: dict[str, Any]) -> None:
        if "position" not in view.get("rover", {}):
            return
        place = np.array(view["rover"]["position"])
        self._publish_position(place)
        truth = rover_position(self._film.truth[view["frame"] % len(self._film.truth)])
        self.driven.add(_on_map(truth), _on_map(place))
        self._worst = max(self._worst, float(np.linalg.norm(place - truth)))
        self._frames += 1


def _on_map(position: Floats) -> Point:
    return float(position[0]), float(position[1])
