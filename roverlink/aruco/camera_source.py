"""Which camera a command looks through: its options, and the question where nobody said."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from roverlink.console import note, rate

if TYPE_CHECKING:
    from roverlink.vision.frames import FrameSource

PARAMETERS = Path("charuco_camera_params.yml")
"""Where a camera's parameters are written and looked for."""

_CAMERA = "0"
_SIZE = re.compile(r"([1-9]\d{0,4})x([1-9]\d{0,4})")


def add_source(parser: argparse.ArgumentParser) -> None:
    """The options that say where frames come from."""
    parser.add_argument(
        "source",
        nargs="?",
        help="number of a camera, URL of a stream (http, https, rtsp), video file, or folder of images "
        "(default: asks, or camera 0 where nobody can be asked)",
    )
    parser.add_argument("--size", type=_size, metavar="WxH", help="ask a camera for images of this size")
    parser.add_argument("--rate", type=rate, metavar="HZ", help="images a second of a folder (default: 30)")


def open_source(
    arguments: argparse.Namespace, size: tuple[int, int] | None = None, say: Callable[[str], None] = note
) -> FrameSource:
    """Open what the options name, or what somebody answers; `size` is asked for where the options say none.

    `say` hears what is worth knowing, also later: of a camera that has gone, or is back. Raises `SetupError` for what
    cannot be opened.
    """
    from roverlink.vision import frames

    text = arguments.source if arguments.source is not None else _asked(say)
    return frames.open_source(text, size=arguments.size or size, rate=arguments.rate or frames.RATE, say=say)


def _asked(say: Callable[[str], None]) -> str:
    """The answer of whoever sits at the terminal; camera 0 where nobody does."""
    if not (sys.stdin.isatty() and sys.stderr.isatty()):
        say(f"no source is given: looking through camera {_CAMERA}")
        return _CAMERA
    print("Camera (ENTER for camera 0, a number, or a URL): ", end="", file=sys.stderr, flush=True)
    return sys.stdin.readline().strip() or _CAMERA


def _size(text: str) -> tuple[int, int]:
    found = _SIZE.fullmatch(text)
    if not found:
        raise argparse.ArgumentTypeError(f"{text!r} is not a size such as 1280x720")
    return int(found[1]), int(found[2])
