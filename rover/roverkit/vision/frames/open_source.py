"""Opening of a source of frames (camera, stream, video or folder of images) that the user has named."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from urllib.parse import urlsplit, urlunsplit

from roverkit.vision.camera.camera_settings import CameraSettings
from roverkit.vision.frames.frame import RATE, FrameSource
from roverkit.vision.frames.live import PORTS, Say, open_camera, open_pipeline, open_stream
from roverkit.vision.frames.recorded import IMAGES, VIDEOS, ImageFiles, VideoFile
from roverlink.bounded_files import open_regular
from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.ros_time.clock import SYSTEM_CLOCK, Clock

TOPIC = "topic:"
"""Start of the text that names a ROS 2 topic."""
PIPELINE = "gstreamer:"
"""Start of the text that is a GStreamer pipeline."""
_WEBCAM = "/video"
"""Path of the stream of the phone app IP Webcam; users often give the address of its web page instead."""
_DEVICE = re.compile(r"/dev/video(\d+)")
_HOST = re.compile(r"(localhost|[\w-]+(\.[\w-]+)+|[\w-]+(?=:)|\[[0-9A-Fa-f:]+\])(:\d+)?([/?].*)?")


def open_source(
    text: str,
    settings: CameraSettings = CameraSettings(),  # noqa: B008  # it is frozen
    *,
    size: tuple[int, int] | None = None,
    rate: float = RATE,
    say: Say = lambda _: None,
    clock: Clock = SYSTEM_CLOCK,
    open_topic: Callable[[str], FrameSource] | None = None,
) -> FrameSource:
    """Open the source of frames that a text names: a camera's number, a device, a file, a folder, a URL, or a topic.

    Examples of the text: ``0``, ``/dev/video2``, ``drive.mp4``, ``rtsp://192.168.0.7/live``, ``192.168.0.7:8080``,
    ``topic:/camera/image_raw``, ``gstreamer:v4l2src ! ...``. `open_topic` is called with the name of a topic.
    `settings` are those of a camera; a folder has a rate and a stream a latency. If they name no size, `size` (width,
    height) is requested; if they name no rate, a folder has `rate` images a second. `say` is called with messages about
    a live source that stalls, ends or works again, and `clock` gives the stamps of its frames. Raises `SetupError` if
    the source cannot be opened, or if it does not have a setting.
    """
    text = text.strip()
    if text.startswith(TOPIC) and open_topic is not None:
        settings.check(text)
        return open_topic(text.removeprefix(TOPIC))
    if text.startswith(PIPELINE):
        return open_pipeline(text.removeprefix(PIPELINE), settings, say, clock)
    camera = camera_number(text)
    if camera is not None:
        if settings.size is None:
            settings = replace(settings, size=size)
        return open_camera(camera, settings, say, clock)
    path = Path(text).expanduser()
    if "://" in text:
        return open_stream(_urls(text), settings, say, clock)
    if text and path.exists():
        if not path.is_dir():
            open_regular(path).close()  # OpenCV would wait for a pipe
        if path.is_dir() or path.suffix.lower() in IMAGES:
            settings.check(text, "rate")
            return ImageFiles(path, settings.rate or rate, say)
        settings.check(text)
        return VideoFile(path)
    if _HOST.fullmatch(text) and path.suffix.lower() not in IMAGES | VIDEOS:
        return open_stream(_urls(f"http://{text}"), settings, say, clock)
    raise SetupError(
        f"no file or folder {text!r}; a source can also be the number of a camera, a URL ({', '.join(PORTS)}), "
        f"{TOPIC}NAME, or {PIPELINE}PIPELINE"
    )


def camera_number(text: str) -> int | None:
    """Return the number of the camera that a text names by its number or device; None if it names another source."""
    device = _DEVICE.fullmatch(str(Path(text).resolve())) if text.startswith("/dev/") else None
    number = device[1] if device else text
    return int(number) if number.isdecimal() else None


def _urls(text: str) -> tuple[str, ...]:
    """Return the URLs to try: the URL in the text, and the same with ``/video``, as the app IP Webcam needs it."""
    try:
        parts = urlsplit(text)
    except ValueError as error:
        raise SetupError(f"{text}: not a valid URL: {error}") from error
    if parts.scheme.lower() not in PORTS:
        raise SetupError(f"{text}: unknown scheme {parts.scheme!r} (known: {', '.join(PORTS)})")
    if parts.scheme.lower() == "rtsp" or parts.path.endswith(_WEBCAM):
        return (text,)
    return text, urlunsplit(parts._replace(path=parts.path.rstrip("/") + _WEBCAM))
