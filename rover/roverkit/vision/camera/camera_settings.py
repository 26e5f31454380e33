"""Settings of a camera: what is requested from its driver, and the latency of its frames."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, fields
from typing import Any

from roverkit.vision.opencv import cv2
from roverlink.runtime.core.errors import SetupError

_FOURCC = re.compile(r"[A-Z0-9]{4}")
_MANUAL = 1  # V4L2_EXPOSURE_MANUAL, which OpenCV passes to the driver as it is
_EXPOSURE_UNITS = 10  # V4L2_CID_EXPOSURE_ABSOLUTE is in units of 100 us
_NEAR = 0.01  # relative; a driver rounds


@dataclass(frozen=True, slots=True)
class CameraSettings:
    """Settings that the user has chosen; what is None is left as it is."""

    size: tuple[int, int] | None = None
    """Width and height of the images in pixels."""
    rate: float | None = None
    """Frames a second."""
    format: str | None = None
    """Pixel format by its FOURCC code, such as MJPG: many USB cameras give their full rate only with it."""
    exposure: float | None = None
    """Exposure time in milliseconds; it ends the automatic exposure."""
    gain: float | None = None
    """Gain in the units of the driver."""
    focus: float | None = None
    """Focus in the units of the driver; it ends the automatic focus."""
    latency: float | None = None
    """Time in seconds from the exposure to the stamp of a frame; it is subtracted from the stamp."""

    def __post_init__(self) -> None:
        if self.format is not None and not _FOURCC.fullmatch(self.format):
            raise SetupError(f"{self.format!r} is no pixel format; use a FOURCC code, such as MJPG or YUYV")
        for name in ("rate", "exposure"):
            if (value := getattr(self, name)) is not None and not 0 < value < 1e6:
                raise SetupError(f"the {name} {value:g} is not possible; it must be more than 0")
        if self.latency is not None and not 0 <= self.latency < 10:
            raise SetupError(f"a latency of {self.latency:g} s is not possible; it must be from 0 to 10 s")

    @property
    def latency_ns(self) -> int:
        """Latency in nanoseconds."""
        return round((self.latency or 0) * 1e9)

    def check(self, name: str, *known: str) -> None:
        """Raise `SetupError` if a setting is given that the source ``name`` does not know; it knows ``known``."""
        for field in fields(self):
            if getattr(self, field.name) is not None and field.name not in known:
                raise SetupError(f"{name}: the setting {field.name!r} has no effect on this kind of source; remove it")

    def apply(self, capture: Any) -> Iterator[str]:
        """Request the settings from an open `VideoCapture`; yield a message for each one that it does not take over."""
        if self.format is not None:
            # First: the format decides which sizes and rates there are.
            capture.set(cv2.CAP_PROP_FOURCC, cv2.VideoWriter_fourcc(*self.format))
            now = int(capture.get(cv2.CAP_PROP_FOURCC)).to_bytes(4, "little").decode("latin-1")
            if now != self.format:
                yield f"the camera does not give the format {self.format}; it gives {now}"
        if self.size is not None:
            capture.set(cv2.CAP_PROP_FRAME_WIDTH, self.size[0])
            capture.set(cv2.CAP_PROP_FRAME_HEIGHT, self.size[1])
        if self.exposure is not None:
            capture.set(cv2.CAP_PROP_AUTO_EXPOSURE, _MANUAL)
        if self.focus is not None:
            capture.set(cv2.CAP_PROP_AUTOFOCUS, 0)
        for name, value, key, units in (
            ("rate", self.rate, cv2.CAP_PROP_FPS, 1),
            ("exposure", self.exposure, cv2.CAP_PROP_EXPOSURE, _EXPOSURE_UNITS),
            ("gain", self.gain, cv2.CAP_PROP_GAIN, 1),
            ("focus", self.focus, cv2.CAP_PROP_FOCUS, 1),
        ):
            if value is None:
                continue
            capture.set(key, value * units)
            now = capture.get(key) / units
            if abs(now - value) > _NEAR * max(abs(value), 1):
                yield f"the camera does not take the {name} {value:g}; it is {now:g}"
