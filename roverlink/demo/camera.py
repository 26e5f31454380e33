"""Camera of ``roverlink demo``: a child process ``roverlink aruco track`` that reads rendered images, not a camera.

It is a process of its own, as on a rover, so its computations do not delay the demo's messages to peers.
"""

from __future__ import annotations

import roverlink.vision  # noqa: F401  # first: it explains how to install numpy and OpenCV

# isort: split

import json
import signal
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import IO, cast

import numpy as np

from roverlink.console import NO_MIDDLEWARE
from roverlink.demo.field import SIDE, landmarks, render_film, rover_position, write_cameras, write_field
from roverlink.runtime import Registry, SetupError
from roverlink.runtime.middleware import Middleware
from roverlink.vision.camera.camera_model import Floats
from roverlink.vision.opencv import cv2
from roverlink.vision.ros.rover_position import ROW, position_publisher

_TIMEOUT_S = 20.0


class DemoCamera:
    """Simulated camera. A child process computes the rover's position from a film of rendered images, in a loop.

    A context manager: the child process starts on entry and ends on exit.
    """

    rows = (ROW,)
    """Names of the rows on whose topics the camera publishes, so the demo does not simulate their messages."""

    def __init__(self, project: Path, middleware: str) -> None:
        """Render the film, write the files for the child process, and prepare its command line.

        With the middleware ``memory``, call `publish_on`, because the child process has no access to the topics of
        this process. With any other middleware, the child process publishes the rover's position itself.
        """
        self._film = render_film()
        self._folder = TemporaryDirectory(prefix="roverlink-camera-")
        folder = Path(self._folder.name)
        frames = folder / "frames"
        self._command = [sys.executable, "-m", "roverlink", "aruco", "track", str(folder / "cameras.yaml")]
        self._command += ["--loop", "--json", "--side", str(SIDE)]
        self._command += ["--landmarks", str(folder / "landmarks.yaml")]
        self._command += ["--middleware", NO_MIDDLEWARE if middleware == "memory" else middleware]
        self._command += ["--project", str(project), "--ros-args", "--log-level", "warn"]
        self._publish_position: Callable[[Floats], None] = lambda _: None
        self._frames = 0
        self._worst = 0.0
        frames.mkdir()
        write_field(folder)
        write_cameras(folder)
        for frame in self._film:
            cv2.imwrite(str(frames / f"{frame.number}.png"), frame.image)

    def publish_on(self, middleware: Middleware, registry: Registry, topic: Callable[[str], str]) -> None:
        """Publish the positions that the child process computes through ``middleware``, which belongs to this process.

        ``topic`` returns the fully qualified name of a topic of the table.
        """
        self._publish_position = position_publisher(middleware, registry, topic)

    def __enter__(self) -> DemoCamera:
        self._child = subprocess.Popen(  # noqa: S603  # our own program
            self._command, stdout=subprocess.PIPE, text=True
        )
        self._output = cast(IO[str], self._child.stdout)
        first = self._output.readline()
        if not first:
            self._child.wait()
            raise SetupError("the demo's camera process did not start; see its messages above")
        self._thread = threading.Thread(target=self._listen, daemon=True)
        self._thread.start()
        return self

    def stop(self) -> str:
        """End the child process. Return a text for the user: the number of images, and the largest position error."""
        self._child.send_signal(signal.SIGINT)
        self._child.wait(_TIMEOUT_S)
        self._thread.join()
        known = len(landmarks().places)
        return (
            f"the simulated camera located the rover in {self._frames} frames with {known} landmarks; "
            f"largest error {1e3 * self._worst:.0f} mm"
        )

    def __exit__(self, *_: object) -> None:
        if self._child.poll() is None:
            self._child.kill()
            self._child.wait()
        self._output.close()
        self._folder.cleanup()

    def _listen(self) -> None:
        for line in self._output:
            view = json.loads(line)
            if "position" not in view.get("rover", {}):
                continue
            place = np.array(view["rover"]["position"])
            self._publish_position(place)
            truth = rover_position(self._film.truth[view["frame"] % len(self._film.truth)])
            self._worst = max(self._worst, float(np.linalg.norm(place - truth)))
            self._frames += 1
