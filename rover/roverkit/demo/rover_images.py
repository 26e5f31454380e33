"""Images of the camera of the demo's rover, which camera programs read over HTTP, as from a phone with a camera app."""

from __future__ import annotations

import roverkit.vision  # noqa: F401  # first: it explains how to install numpy and OpenCV

# isort: split

import threading
import time
from collections import defaultdict
from contextlib import ExitStack
from functools import partial
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler
from pathlib import Path

from roverkit.demo.demo_rover import DemoRover
from roverkit.demo.field import write_field
from roverkit.driving.arcs import PlanarPose
from roverkit.simulation.rover_camera import RoverCamera
from roverkit.vision.opencv import cv2
from roverlink.runtime.net.http_server import HttpServer
from roverlink.runtime.net.page_requests import IMAGE_STREAM, image_part

RATE_HZ = 10.0
"""Images per second."""
_SEED = 1
_QUALITY = 95  # of JPEG; compression must not add to the errors of the tracker


class SentImages:
    """True poses of the rover in the images that one program was sent."""

    def __init__(self) -> None:
        self._connections: list[tuple[int, list[PlanarPose]]] = []
        self._first = 0

    def connect(self) -> list[PlanarPose]:
        """Begin a connection of the program, and return the list to which the poses are added."""
        poses: list[PlanarPose] = []
        self._connections.append((time.time_ns(), poses))
        return poses

    def pose(self, number: int, stamp: int) -> PlanarPose:
        """Return the pose in the image that the program has numbered, and got at a time in nanoseconds.

        Call this for images in the order of their numbers, which go on after a connection was lost.
        """
        while len(self._connections) > 1 and self._connections[1][0] <= stamp:
            del self._connections[0]
            self._first = number
        return self._connections[0][1][number - self._first]


class RoverImages:
    """Camera that takes images of the landmarks at the true pose of the rover.

    A context manager: a thread renders the images inside the block. Rendering takes a large part of a processor's time,
    so a computer that is too slow gets fewer images.
    """

    def __init__(self, rover: DemoRover, folder: Path) -> None:
        """Write the parameters of the camera and the landmarks into a folder, and bind a free port."""
        write_field(folder)
        self._rover, self._camera = rover, RoverCamera(folder / "landmarks.yaml", _SEED)
        self._news = threading.Condition()
        self._number, self._newest = 0, (PlanarPose(), b"")
        self._ended = threading.Event()
        self._sent = defaultdict[str, SentImages](SentImages)
        handler = type("Handler", (_Handler,), {"images": self})
        self._server = HttpServer("127.0.0.1", 0, "images of the camera", handler)
        self._thread = threading.Thread(target=self._render, name="camera", daemon=True)

    def url(self, program: str) -> str:
        """Return the URL at which a program reads the images."""
        return f"{self._server.url}{program}.mjpg"

    def sent(self, program: str) -> SentImages:
        """Return the poses in the images that a program was sent."""
        return self._sent[f"/{program}.mjpg"]

    def send(self, to: BaseHTTPRequestHandler) -> None:
        """Send each new image, until the program leaves or the camera ends."""
        poses, number = self._sent[to.path].connect(), 0
        while True:
            with self._news:
                self._news.wait_for(partial(self._is_after, number))
                number, (pose, jpeg) = self._number, self._newest
            if self._ended.is_set():
                return
            poses.append(pose)
            to.wfile.write(image_part(jpeg))

    def _is_after(self, number: int) -> bool:
        return self._number > number or self._ended.is_set()

    def __enter__(self) -> RoverImages:
        with ExitStack() as stack:
            stack.enter_context(self._server)
            self._thread.start()
            self._stack = stack.pop_all()
        return self

    def __exit__(self, *_: object) -> None:
        self._ended.set()
        with self._news:
            self._news.notify_all()
        self._thread.join()
        self._stack.close()

    def _render(self) -> None:
        due = time.monotonic()
        while not self._ended.wait(due - time.monotonic()):
            pose = self._rover.pose
            _, jpeg = cv2.imencode(".jpg", self._camera.image(pose), [cv2.IMWRITE_JPEG_QUALITY, _QUALITY])
            with self._news:
                self._number, self._newest = self._number + 1, (pose, jpeg.tobytes())
                self._news.notify_all()
            due = max(due + 1 / RATE_HZ, time.monotonic())


class _Handler(BaseHTTPRequestHandler):
    images: RoverImages

    def do_GET(self) -> None:
        """Answer with a stream of images."""
        self.send_response(HTTPStatus.OK)
        self.send_header("Content-Type", IMAGE_STREAM)
        self.end_headers()
        self.images.send(self)
