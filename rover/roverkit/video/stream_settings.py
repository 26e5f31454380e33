"""Settings of a video stream."""

from __future__ import annotations

import re
from dataclasses import dataclass

from roverkit.video.video_declarations import OVERLAYS
from roverkit.vision.camera.camera_settings import CameraSettings
from roverlink.runtime.core.errors import SetupError, nearest

PORT = 4500
"""Port of the first stream on the basestation."""
BITRATE = 1000.0
"""Default bitrate in kbit/s."""
LOWEST_BITRATE = 150.0
"""Default of the least bitrate in kbit/s."""
RATE = 30.0
"""Default images a second."""
_NAME = re.compile(r"[a-z][a-z0-9_]*")


@dataclass(frozen=True, slots=True)
class StreamSettings:
    """Stream: the images, how they are encoded, and where they are sent."""

    name: str
    source: str
    """Source of frames, as `open_source` takes it."""
    host: str
    """Name or address of the receiver's computer."""
    port: int = PORT
    running: bool = True
    """False if nothing is sent, and the source is closed."""
    size: tuple[int, int] | None = None
    """Width and height of the sent images in pixels, both even; None for those of the source."""
    rate: float = RATE
    """Most images a second."""
    bitrate: float = BITRATE
    """Most bits that are sent in kbit/s, on average over a quarter of a second."""
    min_bitrate: float = LOWEST_BITRATE
    """Bitrate in kbit/s below which congestion does not press the stream."""
    overlay: tuple[str, ...] = ()
    """What is drawn into the images: some of `OVERLAYS`."""
    pipeline: str = ""
    """Pipeline of GStreamer that encodes and sends the images, or the name of one; empty for the own encoder."""
    camera: CameraSettings = CameraSettings()  # noqa: RUF009  # it is frozen
    """Further settings that are requested from a camera."""

    def __post_init__(self) -> None:
        """Raise `SetupError` if a value is not possible; the message does not name the stream."""
        if not _NAME.fullmatch(self.name):
            raise SetupError(f"the name {self.name!r} becomes a part of topics; use letters a-z, digits and _")
        if not self.source:
            raise SetupError("there is no source; name a camera, topic:NAME, a video file, a folder or a URL")
        if not self.host:
            raise SetupError("there is no host; name the basestation's address, such as 10.0.0.7")
        if not 1 <= self.port <= 65_535:
            raise SetupError(f"the port is {self.port}; it must be from 1 to 65535")
        if self.size and (min(self.size) < 16 or max(self.size) > 8192 or any(side % 2 for side in self.size)):
            raise SetupError(
                "the size is {}x{}; width and height must be even, and from 16 to 8192 pixels".format(*self.size)
            )
        if not 0.1 <= self.rate <= 240:
            raise SetupError(f"the rate is {self.rate:g}; it must be from 0.1 to 240 images a second")
        if not 10 <= self.min_bitrate <= self.bitrate <= 100_000:
            raise SetupError(
                f"the bitrate is {self.bitrate:g} and the least one {self.min_bitrate:g} kbit/s; both must be from 10 "
                "to 100000, and the least one must not be larger"
            )
        for overlay in self.overlay:
            if overlay not in OVERLAYS:
                raise SetupError(f"unknown overlay {overlay!r}; {nearest(overlay, OVERLAYS)}")
