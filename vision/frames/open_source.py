"""Opening of a source of frames (camera, stream, video or folder of images) that the user has named."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from urllib.parse import urlsplit, urlunsplit

from roverlink.runtime.core.errors import SetupError
from roverlink.vision.frames.frame import RATE, FrameSource
from roverlink.vision.frames.live import Say, open_camera, open_stream
from roverlink.vision.frames.recorded import IMAGES, VIDEOS, ImageFiles, VideoFile

SCHEMES = ("http", "https", "rtsp")
TOPIC = "topic:"
"""Start of the text that names a ROS 2 topic."""
_WEBCAM = "/video"
"""Path of the stream of the phone app IP Webcam; users often give the address of its web page instead."""
_DEVICE = re.compile(r"/dev/video(\d+)")
_HOST = re.compile(r"(localhost|[\w-]+(\.[\w-]+)+|[\w-]+(?=:)|\[[0-9A-Fa-f:]+\])(:\d+)?([/?].*)?")


def open_source(
    text: str,
    *,
    size: tuple[int, int] | None = None,
    rate: float = RATE,
    say: Say = lambda _: None,
    open_topic: Callable[[str], FrameSource] | None = None,
) -> FrameSource:
    """Open the source of frames that a text names: a camera's number, a device, a file, a folder, a URL, or a topic.

    Examples of the text: ``0``, ``/dev/video2``, ``drive.mp4``, ``rtsp://192.168.0.7/live``, ``192.168.0.7:8080``,
    ``topic:/camera/image_raw``. `open_topic` is called with the name of a topic.
    `size` (width, height) is requested from a camera. `rate` is the number of images a second for a folder. `say` is
    called with messages about a live source that stalls, ends or works again. Raises `SetupError` if the source cannot
    be opened.
    """
    text = text.strip()
    if text.startswith(TOPIC) and open_topic is not None:
        return open_topic(text.removeprefix(TOPIC))
    path = Path(text).expanduser()
    device = _DEVICE.fullmatch(str(path.resolve())) if text.startswith("/dev/") else None
    if device or text.isdecimal():
        return open_camera(int(device[1] if device else text), size, say)
    if "://" in text:
        return open_stream(_urls(text), say)
    if text and path.exists():
        images = path.is_dir() or path.suffix.lower() in IMAGES
        return ImageFiles(path, rate, say) if images else VideoFile(path)
    if _HOST.fullmatch(text) and path.suffix.lower() not in IMAGES | VIDEOS:
        return open_stream(_urls(f"http://{text}"), say)
    raise SetupError(
        f"no file or folder {text!r}; a source can also be the number of a camera, a URL ({', '.join(SCHEMES)}), or "
        f"{TOPIC}NAME"
    )


def _urls(text: str) -> tuple[str, ...]:
    """Return the URLs to try: the URL in the text, and the same with ``/video``, as the app IP Webcam needs it."""
    try:
        parts = urlsplit(text)
    except ValueError as error:
        raise SetupError(f"{text}: not a valid URL: {error}") from error
    if parts.scheme.lower() not in SCHEMES:
        raise SetupError(f"{text}: unknown scheme {parts.scheme!r} (known: {', '.join(SCHEMES)})")
    if parts.scheme.lower() == "rtsp" or parts.path.endswith(_WEBCAM):
        return (text,)
    return text, urlunsplit(parts._replace(path=parts.path.rstrip("/") + _WEBCAM))
