"""Decoder of H.264, with FFmpeg's libraries."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from roverkit.video.av_library import av
from roverkit.video.h264 import byte_stream
from roverkit.vision.markers.detection import Image


class Decoder:
    """Decoder of a stream. It begins with a key frame; damaged images are shown as well as they can be."""

    def __init__(self) -> None:
        self._context: Any = av.CodecContext.create("h264", "r")
        self._context.flags |= int(av.codec.context.Flags.low_delay)  # an image comes out with its own packet
        self._context.thread_count = 1

    def decode(self, nals: Sequence[bytes]) -> Image | None:
        """Return the BGR image (H, W, 3) of an access unit; None before the first key frame, or if nothing is left."""
        image: Image | None = None
        try:
            for frame in self._context.decode(av.Packet(byte_stream(nals))):
                image = frame.to_ndarray(format="bgr24")
        except av.FFmpegError:  # the access unit is damaged
            return None
        return image
