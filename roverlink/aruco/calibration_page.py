"""``roverlink aruco calibrate --page``: a page in the browser on which views are taken, dropped and calibrated."""

from __future__ import annotations

import ipaddress
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

from roverlink.vision.calibration.page.live_calibration import LiveCalibration
from roverlink.vision.calibration.page.server import PageServer

_LOOK_S = 0.2
_FAREWELL_S = 1.0
"""For which the page is still there when all is done, so that every browser hears of it."""

Feed = Callable[[threading.Event], None]
"""Shows frames to a calibration until there are no more, or until the event."""


def serve_page(
    live: LiveCalibration, feed: Feed, address: str, port: int, say: Callable[[str], None], *, waits: bool
) -> None:
    """Serve the page until a calibration is saved there; the frames may end before.

    `waits` says that `feed` may be waiting for a camera: then it is left to end when the camera is closed. Raises
    `SetupError` where the page cannot be served, and whatever `feed` raises.
    """
    stop = threading.Event()
    frames = ThreadPoolExecutor(1, "frames")  # of its own: what is clicked must not wait for a camera that is gone
    with PageServer(address, port, live) as server:
        say(f"open {server.url} in a browser")
        if not _is_loopback(address):
            say(f"whoever reaches {address} sees the camera there, and can press the buttons")
        feeding = frames.submit(feed, stop)
        try:
            while not live.finished.wait(_LOOK_S):
                if feeding.done():
                    feeding.result()  # raises what ended it, if that was an error
            time.sleep(_FAREWELL_S)
        finally:
            stop.set()
            frames.shutdown(wait=not waits)


def _is_loopback(address: str) -> bool:
    try:
        return ipaddress.ip_address(address).is_loopback
    except ValueError:
        return address == "localhost"
