"""Parameters of ``roverlink video send``: those of each stream, which ROS 2 can read and change."""

from __future__ import annotations

import argparse
import logging
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from roverkit.node.camera_source import image_size
from roverkit.node.declared_parameters import DeclaredParameters
from roverkit.video.stream_settings import StreamSettings
from roverkit.video.video_declarations import STREAM_PARAMETERS
from roverkit.vision.camera.camera_settings import CameraSettings
from roverkit.vision.frames.open_source import camera_number
from roverlink.nodes import filled
from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.interfaces.rcl_interfaces import ParameterValue
from roverlink.runtime.ros_arguments.ros_args import RosArguments

Streams = tuple[StreamSettings, ...]

_KEYS = tuple(one.name.partition(".")[2] for one in STREAM_PARAMETERS)
"""Keys of the parameters of each stream."""
_READ: Mapping[int, Callable[[str], Any]] = {
    ParameterValue.BOOL: {"true": True, "false": False}.__getitem__,
    ParameterValue.INTEGER: int,
    ParameterValue.DOUBLE: float,
}


class StreamParameters(DeclaredParameters[Streams]):
    """Parameters of the node: ``NAME.KEY`` for each stream and each of its keys."""

    def __init__(
        self,
        streams: Sequence[StreamSettings],
        ros: RosArguments,
        changed: Callable[[Streams], None],
        logger: logging.Logger,
    ) -> None:
        """Read the first values; `changed` is called with all streams after each change.

        Raises `SetupError` if a value is wrong.
        """
        self._changed = changed
        declared = [replace(one, name=filled(one.name, stream.name)) for stream in streams for one in STREAM_PARAMETERS]
        options = {f"{stream.name}.{key}": _value(stream, key) for stream in streams for key in _KEYS}

        def read(values: Mapping[str, Any]) -> Streams:
            return tuple(_read(stream, values) for stream in streams)

        super().__init__(declared, options, ros, read, logger)

    def change(self, changes: Mapping[str, Any]) -> None:
        """Change parameters, and with them the streams. Raises `SetupError` if that is not possible."""
        super().change(changes)
        self._changed(self.meaning)

    def parsed(self, texts: Mapping[str, str]) -> dict[str, Any]:
        """Return the values of parameters that a user has written. Raises `SetupError` for a wrong name or value."""
        values = {}
        for name, text in texts.items():
            declared = self.descriptors.get(name)
            read = _READ.get(declared.type) if declared else None
            try:
                values[name] = read(text) if read else text
            except (KeyError, ValueError):
                values[name] = text  # which `_checked` refuses
        return self._checked(values)

    def by_stream(self) -> dict[str, dict[str, Any]]:
        """Return the values of the parameters, by the stream and by the key."""
        values = self.values
        return {stream.name: {key: values[f"{stream.name}.{key}"] for key in _KEYS} for stream in self.meaning}


def _value(stream: StreamSettings, key: str) -> Any:
    value = getattr(stream, key)
    if key == "size":
        return "{}x{}".format(*value) if value else ""
    if key == "overlay":
        return ",".join(value)
    return value


def _read(stream: StreamSettings, values: Mapping[str, Any]) -> StreamSettings:
    """Return the settings of a stream with the values of its parameters."""
    given = {key: values[f"{stream.name}.{key}"] for key in _KEYS}
    try:
        size = image_size(given["size"]) if given["size"] else None
    except argparse.ArgumentTypeError as error:
        raise SetupError(f"the parameter '{stream.name}.size' is wrong: {error}") from error
    overlay = tuple(name.strip() for name in given["overlay"].split(",") if name.strip())
    # The settings of a camera fit another camera, but not a topic or a file.
    fits = given["source"] == stream.source or camera_number(given["source"]) is not None
    camera = stream.camera if fits else CameraSettings()
    try:
        return replace(stream, **{**given, "size": size, "overlay": overlay, "camera": camera})
    except SetupError as error:
        raise SetupError(f"stream {stream.name}: {error}") from error
