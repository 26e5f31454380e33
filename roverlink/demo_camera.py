"""The camera of the demo: rendered frames of four landmarks on a field, tracked as those of a real one would be."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from roverlink.commands.aruco.track import NODE
from roverlink.tracking import ROVER, place_teller
from runtime import Registry
from runtime.middleware import Middleware, NodeIdentity
from vision import CameraParameters, Landmark, Landmarks, MarkerSet, Pose, Tracker
from vision._opencv import cv2
from vision.detection import Image
from vision.messages import FrameNames
from vision.publishing import Publishing
from vision.rendering import Lens, Print, marker_print, render, texture
from vision.rendering import Pose as PrintPose
from vision.sources import Frame, play
from vision.view import look

FRAMES = 16
RATE_HZ = 10.0
SIDE = 0.15
"""Metres."""
_SIZE = (640, 480)
_LENS = Lens(
    np.array([[600.0, 0, 322.5], [0, 602.0, 236.0], [0, 0, 1]]),
    (0.100096, -0.256227, 0.00111085, 0.000269882, 0),
    _SIZE,
)
_FACING_US = np.array([[0.0, 0, -1], [-1, 0, 0], [0, 1, 0]])  # right is -y, up is z, out of the print is -x
_AHEAD = np.array([[0.0, 0, 1], [-1, 0, 0], [0, -1, 0]])  # a camera that looks along x
_LANDMARKS = {7: (3.0, 0.9, 0.9), 8: (3.4, 0.2, 1.2), 9: (2.6, -0.5, 0.5), 10: (3.2, -1.0, 1.0)}


@dataclass
class Film:
    """Frames of a drive in a circle, and where the camera is in each: a source as any recording is."""

    frames: tuple[Image, ...]
    truth: tuple[Pose, ...]
    name: str = "rendered frames"
    live: bool = False
    rate: float = RATE_HZ
    total: int | None = FRAMES

    def __iter__(self) -> Iterator[Frame]:
        for number, image in enumerate(self.frames):
            yield Frame(image, round(number * 1e9 / self.rate), number)

    def __enter__(self) -> Film:
        return self

    def __exit__(self, *_: object) -> None:
        pass


def landmarks() -> Landmarks:
    """Where the landmarks are, exactly."""
    return Landmarks("field", {number: Landmark(_on_field(number), 0.001, 0.001) for number in _LANDMARKS})


def parameters() -> CameraParameters:
    """The camera's parameters."""
    return CameraParameters(_LENS.matrix, np.array(_LENS.distortion), _SIZE)


def render_film(frames: int = FRAMES) -> Film:
    """Render the drive, or its first frames: the same every time."""
    rng = np.random.default_rng(1)
    scene = texture(_SIZE, rng)
    truth = tuple(_place(2 * np.pi * index / FRAMES) for index in range(frames))
    drawn = [render(_LENS, scene, [_print(number, place) for number in _LANDMARKS], rng) for place in truth]
    return Film(tuple(np.repeat(image[:, :, None], 3, axis=2) for image in drawn), truth)


def _on_field(number: int) -> Pose:
    return Pose(_FACING_US, np.array(_LANDMARKS[number]))


def _place(angle: float) -> Pose:
    """Where the camera is: takes its points to the field."""
    return Pose(_AHEAD, np.array([0.3 * np.sin(angle), 0.3 * np.cos(angle), 0.6]))


def _print(number: int, camera: Pose) -> tuple[Print, PrintPose]:
    """A landmark, and where it is in the camera's frame."""
    seen = camera.inverse() @ _on_field(number)
    return marker_print(cv2.aruco.DICT_5X5_250, number, SIDE, texels=8), PrintPose(seen.rotation, seen.translation)


class DemoCamera:
    """A camera that looks at the film again and again, in a thread."""

    node = NodeIdentity(NODE)
    tells = (ROVER,)
    """The payloads whose topics it publishes."""

    def __init__(self) -> None:
        self._film = render_film()
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._run, name="camera", daemon=True)
        self._frames = 0
        self._worst = 0.0

    def start(self, middleware: Middleware, registry: Registry) -> None:
        """Look, and publish what is seen."""
        camera = parameters()
        self._tracker = Tracker(camera, MarkerSet(side=SIDE))
        self._publish = Publishing(middleware, camera, FrameNames(), self.node.topic).publish
        self._tell = place_teller(middleware, registry, self.node.topic)
        self._thread.start()

    def stop(self) -> str:
        """Stop; what is to be said of what was seen."""
        self._stopped.set()
        self._thread.join()
        return (
            f"the camera found itself on the field in {self._frames} frames by {len(_LANDMARKS)} landmarks, never more "
            f"than {1e3 * self._worst:.0f} mm from where it was"
        )

    def _run(self) -> None:
        for view in look(play(self._film, loop=True), self._tracker, landmarks()):
            if self._stopped.is_set():
                return
            self._publish(view)
            if view.place:
                self._tell(view.place)
                truth = self._film.truth[view.frame.number % len(self._film.truth)]
                self._worst = max(self._worst, float(np.linalg.norm(view.place.pose.translation - truth.translation)))
                self._frames += 1
