"""The page of ``roverlink aruco calibrate``: where it is served, and what goes on while it is."""

from __future__ import annotations

import argparse
import ipaddress
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING

from roverlink.console import port

if TYPE_CHECKING:
    from vision.calibration.page.live import LiveCalibration
    from vision.sources import FrameSource

PORT = 8788
_LOOPBACK = "127.0.0.1"
_LOOK_S = 0.2
_FAREWELL_S = 1.0
"""For which the page is still served when all is done, so that every browser hears of it."""


def add_page(parser: argparse.ArgumentParser) -> None:
    """The options that say where the page is."""
    parser.add_argument(
        "--page",
        type=port,
        nargs="?",
        const=PORT,
        metavar="PORT",
        help=f"show the picture and what is missing on a page for a browser, on this TCP port ({PORT})",
    )
    parser.add_argument(
        "--page-address",
        default=_LOOPBACK,
        metavar="ADDRESS",
        help="address to serve the page on (default: %(default)s, for this computer alone)",
    )


def calibrate_on_page(
    source: FrameSource, live: LiveCalibration, address: str, port: int, say: Callable[[str], None]
) -> None:
    """Show a source's frames on the page until a calibration is saved there; a recording may end before.

    Raises `SetupError` where the page cannot be served, or the source fails.
    """
    from vision.calibration.page.server import PageServer

    stop = threading.Event()
    frames = ThreadPoolExecutor(1, "frames")  # of its own: what is clicked must not wait for a camera that is gone
    with source, PageServer(address, port, live) as server:
        say(f"open {server.url} in a browser")
        if not _is_loopback(address):
            say(f"whoever reaches {address} can see the camera there, and calibrate it")
        feeding = frames.submit(_feed, source, live, stop)
        try:
            while not live.finished.wait(_LOOK_S) and not (feeding.done() and feeding.exception()):
                pass
            time.sleep(_FAREWELL_S * live.finished.is_set())
        finally:
            stop.set()
            if not source.live:  # it must not be closed while it is read; a live one ends when it is closed
                frames.shutdown()
    frames.shutdown()
    feeding.result()


def _feed(source: FrameSource, live: LiveCalibration, stop: threading.Event) -> None:
    for frame in source:
        if stop.is_set():
            return
        live.look(frame.image, frame.stamp)
    live.ended()


def _is_loopback(address: str) -> bool:
    try:
        return ipaddress.ip_address(address).is_loopback
    except ValueError:
        return address == "localhost"
