"""File of the streams that a rover sends, `video.yaml`.

    host: 10.0.0.7
    link_rate: 4000
    streams:
      front:
        source: topic:/camera/camera/color/image_raw
        port: 4500
        size: [640, 480]
      arm:
        source: /dev/video2
        format: MJPG
        port: 4501
        rate: 15
        bitrate: 500
        overlay: [time, link]

The keys of a stream are those of `StreamSettings`, and those of `CameraSettings` that a camera understands. Bitrates
are in kbit/s. `host` is that of the streams that name none. `link_rate` is the rate in kbit/s at which all
packets together leave. Files are relative to this file.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from roverkit.video.stream_settings import StreamSettings
from roverkit.vision.camera.camera_settings import CameraSettings
from roverkit.vision.yaml_file import Item, read_file
from roverlink.runtime.core.errors import SetupError

SUFFIXES = frozenset((".yaml", ".yml"))
"""Suffixes of a file of streams."""
LINK_RATE = 20_000.0
"""Default of the link's rate in kbit/s."""
_CAMERA = ("format", "exposure", "gain", "focus", "latency")
_TEXTS = ("host", "pipeline", "format")
_NUMBERS = ("rate", "bitrate", "min_bitrate", "exposure", "gain", "focus", "latency")
_KEYS = ("source", "host", "port", "running", "size", "rate", "bitrate", "min_bitrate", "overlay", "pipeline", *_CAMERA)


@dataclass(frozen=True, slots=True)
class StreamsFile:
    """Content of the file."""

    streams: tuple[StreamSettings, ...]
    link_rate: float
    """Rate in kbit/s at which all packets together leave."""

    def __post_init__(self) -> None:
        """Raise `SetupError` if the rate is not possible."""
        if not 10 <= self.link_rate <= 1e7:
            raise SetupError(f"the link rate is {self.link_rate:g} kbit/s; it must be from 10 to 10000000")


def read_streams(path: Path, host: str = "") -> StreamsFile:
    """Read a file of streams; `host` takes the place of the file's. Raises `SetupError`, with line and column."""
    whole = read_file(path, "streams")
    top = whole.known_entries({"host", "link_rate", "streams"})
    entries = top["streams"].entries("stream") if "streams" in top else {}
    if not entries:
        raise whole.error("no streams found under the key 'streams'; see the example in rover/docs/video.md")
    host = host or (_text(top["host"]) if "host" in top else "")
    streams = tuple(_stream(path.parent, name, item, host) for name, item in entries.items())
    taken: dict[tuple[str, int], str] = {}
    for stream, item in zip(streams, entries.values()):
        other = taken.setdefault((stream.host, stream.port), stream.name)
        if other != stream.name:
            raise item.error(f"{item.name} and stream {other} have the same port {stream.port}; give each its own")
    try:
        return StreamsFile(streams, _number(top["link_rate"]) if "link_rate" in top else LINK_RATE)
    except SetupError as error:
        raise top["link_rate"].error(str(error)) from error


def _stream(folder: Path, name: object, item: Item, host: str) -> StreamSettings:
    given = item.known_entries(_KEYS)
    values: dict[str, Any] = {"host": host}
    for key, entry in given.items():
        if key in _TEXTS:
            values[key] = _text(entry)
        elif key in _NUMBERS:
            values[key] = _number(entry)
        elif key == "source":
            values[key] = _source(folder, entry)
        elif key == "port":
            values[key] = _whole(entry)
        elif key == "size":
            width, height = entry.numbers(2)
            values[key] = int(width), int(height)
        elif key == "overlay":
            values[key] = _texts(entry)
        else:
            values[key] = _flag(entry)
    if "source" not in values:
        raise item.error(f"{item.name} has no source; add 'source: topic:/camera/image_raw', or a number, file or URL")
    try:
        camera = CameraSettings(**{key: values.pop(key) for key in _CAMERA if key in values})
        return StreamSettings(str(name), camera=camera, **values)
    except SetupError as error:
        raise item.error(f"{item.name}: {error}") from error


def _source(folder: Path, item: Item) -> str:
    text = item.text or ""
    beside = folder / text
    return str(beside) if text and not text.isdecimal() and beside.exists() else text


def _text(item: Item) -> str:
    item.require(isinstance(item.value, str), "a text (in quotes if it looks like a number)")
    return str(item.value)


def _texts(item: Item) -> tuple[str, ...]:
    items = item.items(f"a part of {item.name}")
    item.require(items is not None, "a list, such as [time, objects]")
    return tuple(_text(item) for item in items or ())


def _number(item: Item) -> float:
    item.require(math.isfinite(item.number), "a number")
    return item.number


def _whole(item: Item) -> int:
    item.require(type(item.value) is int, "a whole number")
    return int(item.value)


def _flag(item: Item) -> bool:
    item.require(isinstance(item.value, bool), "true or false")
    return bool(item.value)
