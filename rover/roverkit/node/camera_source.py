"""Options that select a camera or another source of frames: a stream, a ROS 2 topic, a video, or a folder of images."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from roverkit.node.ros_connection import full_topic

from roverlink.console import count, print_note, rate

if TYPE_CHECKING:
    from roverkit.node.ros_connection import RosConnection
    from roverkit.vision.camera.camera_settings import CameraSettings
    from roverkit.vision.frames import FrameSource

T = TypeVar("T")

PARAMETERS = Path("charuco_camera_params.yml")
"""Default file of a camera's parameters."""

CAMERA_FRAME = "camera_frame"
"""Name of a camera's coordinate frame if neither the user nor the source names it."""

SETTINGS = ("size", "rate", "format", "exposure", "gain", "focus", "latency")
"""Options for the settings of a camera: the fields of `CameraSettings`."""

_CAMERA = "0"
_SIZE = re.compile(r"([1-9]\d{0,4})x([1-9]\d{0,4})")


def add_source(parser: argparse.ArgumentParser) -> None:
    """Add the options that select the source of frames to a parser."""
    parser.add_argument(
        "source",
        nargs="?",
        help="number of a camera, URL of a stream (http, https, rtsp), topic:NAME (ROS 2 topic with images), video "
        "file, folder of images, or gstreamer:PIPELINE (default: the command asks for it in a terminal; elsewhere, "
        "camera 0)",
    )
    add = parser.add_argument_group("settings of the camera").add_argument
    add("--size", type=image_size, metavar="WxH", help="image size in pixels, such as 1280x720")
    add("--rate", type=rate, metavar="HZ", help="images a second; also those of a folder (default there: 30)")
    add("--format", metavar="FOURCC", help="pixel format, such as MJPG, with which many USB cameras are faster")
    add("--exposure", type=float, metavar="MS", help="exposure time in milliseconds instead of the automatic one")
    add("--gain", type=float, metavar="N", help="gain, in the units of the driver")
    add("--focus", type=float, metavar="N", help="focus instead of the automatic one, in the units of the driver")
    add(
        "--latency",
        type=float,
        metavar="S",
        help="seconds from the exposure of a camera's or stream's image to its arrival; stamps are earlier by this "
        "(default: 0)",
    )


def add_playing(parser: argparse.ArgumentParser) -> None:
    """Add the options for how long frames are taken, and for the name of their coordinate frame, to a parser."""
    parser.add_argument("--loop", action="store_true", help="play a video or a folder again and again, until Ctrl-C")
    parser.add_argument("--count", type=count, metavar="N", help="stop after N images")
    parser.add_argument(
        "--camera-frame",
        metavar="NAME",
        help="name of the camera's coordinate frame in all results (default: the frame of the images of a ROS 2 topic; "
        f"for other sources, {CAMERA_FRAME})",
    )


def settings_of(arguments: argparse.Namespace) -> CameraSettings:
    """Return the settings of the camera. Raises `SetupError` if one of them is not possible."""
    from roverkit.vision.camera.camera_settings import CameraSettings

    return CameraSettings(**{name: getattr(arguments, name) for name in SETTINGS})


def source_of(arguments: argparse.Namespace, say: Callable[[str], None]) -> str:
    """Return the text that names the source of frames: that of the options, or else what the user enters."""
    text: str | None = arguments.source
    return (_asked(say) if text is None else text).strip()


def open_source(
    text: str,
    settings: CameraSettings,
    ros: RosConnection,
    size: tuple[int, int] | None = None,
    say: Callable[[str], None] = print_note,
    *,
    rate: float | None = None,
    any_size: bool = False,
) -> FrameSource:
    """Open the source of frames that a text names.

    If the settings have no image size, the camera is asked for images of ``size``; if they have no rate, a folder has
    ``rate`` images a second. With ``any_size``, the images of a ROS 2 topic may change their size. ``say`` is called
    with messages for the user, also later, for instance if the camera is lost. Raises `SetupError` if the source cannot
    be opened.
    """
    from roverkit.vision import frames

    def open_topic(name: str) -> FrameSource:
        return frames.TopicSource(ros.middleware, full_topic(name, ros.arguments), say, ros.clock, any_size=any_size)

    return frames.open_source(
        text, settings, size=size, rate=rate or frames.RATE, say=say, clock=ros.clock, open_topic=open_topic
    )


def with_progress(frames: Iterator[T], sources: Sequence[FrameSource], arguments: argparse.Namespace) -> Iterator[T]:
    """Yield the frames of these sources; show the progress if they end and the terminal does not show JSON."""
    totals = [source.total for source in sources if source.total is not None]
    if arguments.loop or len(totals) < len(sources) or (arguments.json and sys.stdout.isatty()):
        yield from frames
        return
    from roverlink.progress import progress

    with progress(", ".join(source.name for source in sources)) as report:
        for done, frame in enumerate(frames, 1):
            yield frame
            report(done, sum(totals))


def _asked(say: Callable[[str], None]) -> str:
    """Return the source that the user enters on the terminal; without a terminal, return camera 0."""
    # Both: the question goes to standard error, because standard output may be a pipe for --json.
    if not (sys.stdin.isatty() and sys.stderr.isatty()):
        say(f"no source given; using camera {_CAMERA}")
        return _CAMERA
    print(
        "Camera number, URL, topic:NAME, video file or folder (ENTER for camera 0): ",
        end="",
        file=sys.stderr,
        flush=True,
    )
    return sys.stdin.readline().strip() or _CAMERA


def image_size(text: str) -> tuple[int, int]:
    """Parse the size of an image, such as ``1280x720``, as width and height."""
    found = _SIZE.fullmatch(text)
    if not found:
        raise argparse.ArgumentTypeError(f"{text!r} is not an image size, such as 1280x720")
    return int(found[1]), int(found[2])
