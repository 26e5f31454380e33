"""Web page of ``roverlink aruco calibrate --page``, on which the user takes and drops views, and calibrates."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

from roverkit.calibration.page.live_calibration import LiveCalibration
from roverkit.calibration.page.server import PageServer
from roverlink.runtime.net.page_requests import is_loopback

_POLL_S = 0.2
_LINGER_S = 1.0
"""Time in seconds that the page stays available at the end, so that every browser gets the last state."""

Feed = Callable[[threading.Event], None]
"""Function that passes frames to a calibration until they end or the event is set."""


def serve_page(
    live: LiveCalibration, feed: Feed, address: str, port: int, say: Callable[[str], None], *, waits: bool
) -> None:
    """Serve the page until the user has saved a calibration; the frames may end earlier.

    ``feed`` passes the frames to ``live``; it runs on a thread of its own. If ``waits`` is true, ``feed`` may be
    blocked on a camera; then its thread is not joined, and ends when the camera is closed. Raises `SetupError` if the
    page cannot be served, and the errors of ``feed``.
    """
    stop = threading.Event()
    frames = ThreadPoolExecutor(1, "frames")  # its own thread: a click must not wait for a lost camera
    with PageServer(address, port, live) as server:
        say(f"open {server.url} in a web browser")
        if not is_loopback(address):
            say(f"anyone who can reach {address} sees the camera on this page and can press its buttons")
        feeding = frames.submit(feed, stop)
        try:
            # Polls, so that an error of the frame thread is soon raised here.
            while not live.finished.wait(_POLL_S):
                if feeding.done():
                    feeding.result()  # raises its error, if it has one
            time.sleep(_LINGER_S)
        finally:
            stop.set()
            frames.shutdown(wait=not waits)
