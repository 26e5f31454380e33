"""Live sources of frames: cameras and network streams.

A thread reads every frame and stamps it as soon as the frame arrives, so that no frame waits in a queue. An iteration
gets the newest frame. If a source stalls or ends, it is opened again as soon as that is possible.
"""

from __future__ import annotations

import socket
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from typing import Any
from urllib.parse import urlsplit

from roverkit.vision.camera.camera_settings import CameraSettings
from roverkit.vision.frames.frame import Frame, rate_of
from roverkit.vision.frames.newest import Newest
from roverkit.vision.opencv import cv2
from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.ros_time.clock import SYSTEM_CLOCK, Clock

STALLED_S = 3.0
"""Time in seconds without a frame after which a stream is opened again.

V4L2, the camera interface of Linux, has its own limit of ten seconds.
"""
OPENING_S = 5.0
"""Longest time in seconds that a stream may take to answer."""
_ACCEPTING_S = 1.0
"""Longest time in seconds that the computer of a stream may take to accept a connection."""
PAUSE_S = 0.5
"""Time in seconds between two attempts to open a source again. Whoever drives the rover waits for the picture."""
_OLDEST_S = 1.0  # an older driver stamp comes from another clock
_CLOSING_S = STALLED_S + 1.0  # the process would abort if it ended while a thread still waits for a stream
PORTS = {"http": 80, "https": 443, "rtsp": 554}
"""Schemes of the URLs of streams, with the ports that are meant if a URL names none."""
_NEWEST_SINK = "videoconvert ! video/x-raw, format=BGR ! appsink drop=true max-buffers=1 sync=false"

Say = Callable[[str], None]


class LiveSource:
    """Camera or network stream as a source of frames. A thread reads the frames; an iteration yields the newest one."""

    live = True
    total: int | None = None

    def __init__(
        self, name: str, connect: Callable[[], Any], say: Say, latency_ns: int = 0, clock: Clock = SYSTEM_CLOCK
    ) -> None:
        """Open the source; `connect` returns an open `VideoCapture`, or None if that is not possible.

        `say` is called with messages for the user. Stamps are the time of `clock`, minus `latency_ns`. Raises
        `SetupError` if `connect` returns None, or if the source gives no frame.
        """
        self.name = name
        self._connect, self._say, self._latency_ns, self._clock = connect, say, latency_ns, clock
        self._newest: Newest[Frame] = Newest()
        self._taken = 0  # number of the newest frame that was yielded
        self._closed = threading.Event()
        self._number = 0
        self._capture = connect()
        if self._capture is None:
            raise SetupError(f"cannot open {name}; check that it exists, and that no other program uses it")
        if not self._take():
            self._capture.release()
            raise SetupError(f"{name} can be opened but gives no frames; check that no other program uses it")
        self.rate = rate_of(self._capture)
        self._thread = threading.Thread(target=self._read, name="frames", daemon=True)
        self._thread.start()

    def __iter__(self) -> Iterator[Frame]:
        """Yield the newest frame, then wait for a newer one, and so on. No frame is yielded twice."""
        while (found := self._newest.get(self._taken)) and not self._newest.closed:
            self._taken, frame = found
            yield frame

    def __enter__(self) -> LiveSource:
        return self

    def __exit__(self, *_: object) -> None:
        # Nothing interrupts a thread in grab(), and its capture must not be released meanwhile. So it is a daemon
        # thread, and the wait for it is limited.
        self._closed.set()
        self._newest.close()
        self._thread.join(_CLOSING_S)  # a thread blocked on a stream ends after the stream's timeout

    def _read(self) -> None:
        while not self._closed.is_set():
            before = time.monotonic()
            if not self._take():
                self._reopen(time.monotonic() - before)
        if self._capture is not None:
            self._capture.release()

    def _take(self) -> bool:
        """Read a frame and pass it to the iteration; return false if no frame can be read."""
        if self._capture is None or not self._capture.grab():
            return False
        stamp = self._clock.now() - _age_ns(self._capture) - self._latency_ns
        there, image = self._capture.retrieve()
        if not there:
            return False
        # Some cameras deliver grey images; the rest of the program expects BGR.
        if image.ndim == 2:
            image = cv2.cvtColor(image, cv2.COLOR_GRAY2BGR)
        self._newest.put(Frame(image, stamp, self._number))
        self._number += 1
        return True

    def _reopen(self, waited: float) -> None:
        """Try to open the source until it works, or until the source is closed.

        The source gave no frame for `waited` seconds.
        """
        what = f"has stalled: no frame for {waited:.0f} s" if waited > STALLED_S / 2 else "has ended"
        self._say(f"{self.name} {what}; opening it again")
        lost, said = time.monotonic(), False
        self._capture.release()
        while not self._closed.wait(PAUSE_S):
            self._capture = self._connect()
            if self._capture is not None and self._take():
                self._say(f"{self.name} is back after {time.monotonic() - lost:.1f} s")
                return
            if not said:
                said = True
                self._say(f"{self.name} is not available; trying again every {PAUSE_S:g} s")


def _age_ns(capture: Any) -> int:
    """Return for how many nanoseconds a frame is there, by the driver's stamp; 0 if the driver gives none."""
    if capture.getBackendName() != "V4L2":
        return 0
    age = time.monotonic() - capture.get(cv2.CAP_PROP_POS_MSEC) / 1e3  # V4L2 stamps are on the monotonic clock
    return round(age * 1e9) if 0 <= age < _OLDEST_S else 0


def open_camera(index: int, settings: CameraSettings, say: Say, clock: Clock) -> LiveSource:
    """Open the camera with this number. Raises `SetupError` if there is no such camera."""
    # By name on Linux: an OpenCV with GStreamer would prefer it, and then exposure and the driver's stamps are missing.
    backend = cv2.CAP_V4L2 if sys.platform == "linux" else cv2.CAP_ANY
    name = f"camera {index}"
    return LiveSource(name, _connected(name, settings, say, index, backend), say, settings.latency_ns, clock)


def open_pipeline(pipeline: str, settings: CameraSettings, say: Say, clock: Clock) -> LiveSource:
    """Open a GStreamer pipeline; without a sink, one is added that keeps the newest image.

    Raises `SetupError` if this OpenCV is built without GStreamer, or if the pipeline gives no images.
    """
    settings.check("a GStreamer pipeline", "latency")
    if not cv2.videoio_registry.hasBackend(cv2.CAP_GSTREAMER):
        raise SetupError(
            "this OpenCV has no GStreamer (pip's packages never do); use the OpenCV of the system, as on a Jetson, or "
            "let a ROS 2 driver publish the images and use topic:NAME"
        )
    whole = pipeline if "appsink" in pipeline else f"{pipeline} ! {_NEWEST_SINK}"
    connect = _connected("", CameraSettings(), say, whole, cv2.CAP_GSTREAMER)
    return LiveSource(f"GStreamer: {pipeline}", connect, say, settings.latency_ns, clock)


def open_stream(urls: tuple[str, ...], settings: CameraSettings, say: Say, clock: Clock) -> LiveSource:
    """Open the first URL that gives frames. Raises `SetupError` if none does."""
    settings.check(urls[0], "latency")
    limits = [
        *(cv2.CAP_PROP_OPEN_TIMEOUT_MSEC, round(OPENING_S * 1e3)),
        *(cv2.CAP_PROP_READ_TIMEOUT_MSEC, round(STALLED_S * 1e3)),
    ]

    def connect() -> Any:
        if not _accepts(urls[0]):
            return None
        captures = (cv2.VideoCapture(url, cv2.CAP_FFMPEG, limits) for url in urls)
        return next((capture for capture in captures if capture.isOpened()), None)

    return LiveSource(urls[0], connect, say, settings.latency_ns, clock)


def _accepts(url: str) -> bool:
    """Return true if a computer accepts connections at the address in a URL.

    FFmpeg would go on with one connection for `OPENING_S`. If the network drops its first packet, TCP repeats it after
    1 and 3 s only (RFC 6298), so that the return of a camera would be noticed late.
    """
    with suppress(OSError, ValueError):  # a port that is no number, or too large
        place = urlsplit(url)
        socket.create_connection((place.hostname or "", place.port or PORTS[place.scheme]), _ACCEPTING_S).close()
        return True
    return False


def _connected(name: str, settings: CameraSettings, say: Say, *what: object) -> Callable[[], Any]:
    """Return a function that opens a `VideoCapture` and requests the settings; it returns None if it cannot open it."""
    said: set[str] = set()

    def connect() -> Any:
        capture = cv2.VideoCapture(*what)
        if not capture.isOpened():
            return None
        for message in settings.apply(capture):
            if message not in said:
                said.add(message)
                say(f"{name}: {message}")
        return capture

    return connect
