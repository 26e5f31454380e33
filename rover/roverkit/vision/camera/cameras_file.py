"""File of a rover's cameras, `cameras.yaml`: the sources of their images, their parameters, and their mounts.

    cameras:
      front:
        source: topic:/camera/camera/color/image_raw
        mount: {position: [0.30, 0, 0.45], rpy: [0, 10, 0]}
      left:
        source: /dev/video2
        format: MJPG
        size: [1280, 720]
        exposure: 5
        readout_time: 0.02
        parameters: left.yml
        frame: left_optical_frame
        mount: {position: [0.05, 0.25, 0.50], rpy: [0, 0, 90]}

`mount` is the pose of the camera on the rover (REP 103: x ahead, y left, z up for both). `position` is that of the lens
in metres, and `rpy` are degrees about the fixed axes x, y and z, in this order: with `rpy: [0, 0, 0]` the camera looks
ahead, a positive second angle tilts it down, and a positive third one turns it to the left. Without a mount, the
transform from the camera's frame to the rover's is taken from /tf. `readout_time` is that of
`Uncertainty`; the other keys are those of `CameraSettings`. Files are relative to this file.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np

from roverkit.vision.camera.camera_settings import CameraSettings
from roverkit.vision.poses.pose import Pose
from roverkit.vision.poses.pose_entries import POSE, pose
from roverkit.vision.yaml_file import Item, read_file
from roverlink.runtime.core.errors import SetupError

SUFFIXES = frozenset((".yaml", ".yml"))
"""Suffixes of a file of cameras."""
_SETTINGS = tuple(field.name for field in fields(CameraSettings))
_KEYS = ("source", "parameters", "camera_info", "frame", "mount", "readout_time", *_SETTINGS)
_NAME = "abcdefghijklmnopqrstuvwxyz0123456789_"
_OPTICAL = Pose(np.array([[0.0, 0, 1], [-1, 0, 0], [0, -1, 0]]), np.zeros(3))
"""Transform from a camera's optical axes (x right, y down, z ahead) to its body axes (x ahead, y left, z up)."""


@dataclass(frozen=True, slots=True, eq=False)
class CameraEntry:
    """Camera of a rover, as the file describes it."""

    name: str
    source: str
    """Source of frames, as `open_source` takes it."""
    parameters: Path | None = None
    """File of the camera's parameters; None if a ROS 2 topic has to give them."""
    frame: str = ""
    """Name of the camera's optical frame; empty if the images name it."""
    camera_info: str = ""
    """ROS 2 topic with the camera's parameters; empty for the topic beside the source."""
    settings: CameraSettings = CameraSettings()  # noqa: RUF009  # it is frozen
    """Settings that are requested from the camera."""
    readout_time: float | None = None
    """Time in seconds from the first row of an image to the last one; None for a global shutter."""
    mount: Pose | None = None
    """Transform from the camera's optical frame to the rover's frame; None if it is not in the file."""


def read_cameras(path: Path) -> list[CameraEntry]:
    """Read a file of cameras. Raises `SetupError`, with line and column, for missing or impossible values."""
    whole = read_file(path, "cameras")
    top = whole.known_entries({"cameras"})
    entries = top["cameras"].entries("camera") if "cameras" in top else {}
    if not entries:
        raise whole.error("no cameras found under the key 'cameras'; see the example in rover/docs/vision.md")
    return [_camera(path.parent, key, item) for key, item in entries.items()]


def _camera(folder: Path, name: object, item: Item) -> CameraEntry:
    if not isinstance(name, str) or not name or not set(name) <= set(_NAME) or name[0].isdigit():
        raise item.error(
            f"the camera's name is {name!r}; it becomes a part of topics, so use letters a-z, digits and _"
        )
    given = item.known_entries(_KEYS)
    if "source" not in given:
        raise item.error(f"{item.name} has no source; add 'source: topic:/camera/image_raw', or a number, file or URL")
    parameters = folder / given["parameters"].filled_text() if "parameters" in given else None
    frame, info = (given[key].filled_text() if key in given else "" for key in ("frame", "camera_info"))
    if info and parameters:
        raise given["camera_info"].error(f"{item.name} has 'parameters' and 'camera_info'; remove one of them")
    mount = _mount(given["mount"]) if "mount" in given else None
    return CameraEntry(
        name=name,
        source=_source(folder, given["source"]),
        parameters=parameters,
        frame=frame,
        camera_info=info,
        settings=_settings(item, given),
        readout_time=_readout_time(given["readout_time"]) if "readout_time" in given else None,
        mount=mount,
    )


def _settings(item: Item, given: Mapping[str, Item]) -> CameraSettings:
    values: dict[str, Any] = {}
    for key in (key for key in _SETTINGS if key in given):
        entry = given[key]
        if key == "format":
            values[key] = entry.filled_text()
        elif key == "size":
            width, height = entry.numbers(2)
            values[key] = (int(width), int(height))
        else:
            entry.require(math.isfinite(entry.number), "a number")
            values[key] = entry.number
    try:
        return CameraSettings(**values)
    except SetupError as error:
        raise item.error(f"{item.name}: {error}") from error


def _readout_time(item: Item) -> float:
    item.require(0 <= item.number < math.inf, "a number of seconds, at least 0")
    return item.number


def _source(folder: Path, item: Item) -> str:
    text = str(item.value) if isinstance(item.value, int) and not isinstance(item.value, bool) else item.filled_text()
    beside = folder / text
    return str(beside) if beside.exists() and not text.isdecimal() else text


def _mount(item: Item) -> Pose:
    return pose(item, item.known_entries(POSE)) @ _OPTICAL
