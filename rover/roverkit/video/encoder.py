"""Encoder of images as H.264, with FFmpeg's libraries and x264."""

from __future__ import annotations

import os
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roverkit.video.av_library import av
from roverkit.video.h264 import nal_units
from roverkit.video.rtp import CLOCK_HZ
from roverkit.vision.frames.frame import size_of
from roverkit.vision.markers.detection import Image
from roverkit.vision.opencv import cv2
from roverlink.runtime.core.errors import SetupError

_ENCODER = "libx264"
_PRESET = "superfast"
_BUFFER_S = 0.25
"""Time in seconds over which the bitrate is averaged (VBV): what a key frame may delay the images after it."""
_ONE_THREAD = 1280 * 720
"""Number of pixels up to which one thread encodes: a second one takes 10 to 35 % more CPU to be faster."""


def check_encoder() -> None:
    """Raise `SetupError` if this PyAV has no encoder."""
    if _ENCODER not in av.codecs_available:
        raise SetupError(
            "this PyAV has no encoder for H.264 (libx264); install PyAV from PyPI with `pip install av`, or let "
            "GStreamer encode with --pipeline"
        )


class Encoder:
    """Encoder of a stream. An image is encoded at once (zero latency): no image waits for the next one."""

    def __init__(self, size: tuple[int, int], rate: float, bitrate: float) -> None:
        """Open the encoder for images of (width, height), both even, a rate in Hz and a bitrate in bits a second.

        An image gets the bits of its share of a second: if the images come at half the rate, half the bits are used.
        Raises `SetupError` if the encoder refuses the size.
        """
        self.size, self.rate = size, rate
        context: Any = av.CodecContext.create(_ENCODER, "w")
        context.width, context.height = size
        context.pix_fmt = "yuv420p"
        context.time_base = Fraction(1, CLOCK_HZ)
        context.framerate = Fraction(rate).limit_denominator(1000)
        context.bit_rate = round(bitrate)
        context.thread_count = 1 if size[0] * size[1] <= _ONE_THREAD else min(2, os.cpu_count() or 1)
        context.options = {
            "preset": _PRESET,
            "tune": "zerolatency",
            "forced-idr": "1",
            "maxrate": str(round(bitrate)),
            "bufsize": str(round(bitrate * _BUFFER_S)),
            "g": "9999",  # key frames come by time and on request, see `encode`
            "sc_threshold": "0",
        }
        try:
            context.open()
        except av.FFmpegError as error:
            raise SetupError(
                f"the encoder refuses images of {size[0]}x{size[1]} pixels at {bitrate / 1000:g} kbit/s: {error}"
            ) from error
        self._context = context
        # One frame for all images: x264 has copied an image when it returns. A new one costs as much as the conversion.
        self._frame: Any = av.VideoFrame(*size, "yuv420p")
        self._frame.time_base = context.time_base
        self._converted = np.empty((size[1] * 3 // 2, size[0]), np.uint8)
        self._parts = list(zip(map(_pixels, self._frame.planes), _planes(self._converted)))

    def set_bitrate(self, bitrate: float) -> None:
        """Use another bitrate in bits a second, at most the first one, from the next image on."""
        self._context.bit_rate = round(bitrate)  # x264 takes it over without a key frame

    def encode(self, image: Image, timestamp: int, *, key: bool) -> list[bytes]:
        """Return the NAL units of an image of the encoder's size; `timestamp` is in 1/90000 s, and must grow.

        With `key`, the image can be decoded without others; SPS and PPS are before it.
        """
        colour = image if image.ndim == 3 else cv2.cvtColor(image, cv2.COLOR_GRAY2BGR)
        cv2.cvtColor(colour, cv2.COLOR_BGR2YUV_I420, self._converted)
        for plane, part in self._parts:
            plane[:] = part
        self._frame.pts = timestamp
        self._frame.pict_type = av.video.frame.PictureType.I if key else av.video.frame.PictureType.NONE
        return [nal for packet in self._context.encode(self._frame) for nal in nal_units(bytes(packet))]


def _pixels(plane: Any) -> NDArray[np.uint8]:
    """Return the pixels (H, W) of a plane of a frame, as a view; its rows may be longer in memory."""
    return np.frombuffer(plane, np.uint8).reshape(plane.height, plane.line_size)[:, : plane.width]


def _planes(image: NDArray[np.uint8]) -> list[NDArray[np.uint8]]:
    """Return the three planes of an image (H * 3 / 2, W) that OpenCV has converted to I420, as views."""
    rows, width = image.shape
    height = rows * 2 // 3
    colours = image[height:].reshape(2, height // 2, width // 2)
    return [image[:height], colours[0], colours[1]]


def fitted(image: Image, size: tuple[int, int] | None) -> Image:
    """Return an image (H, W[, 3]) scaled to (width, height); without a size, cut by a pixel if a side is odd.

    H.264 halves the resolution of colours, so both sides must be even. Raises `SetupError` if nothing would be left.
    """
    width, height = size_of(image)
    if size is None:
        if min(width, height) < 2:
            raise SetupError(f"the images have {width}x{height} pixels; the encoder needs at least 2x2")
        return image[: height // 2 * 2, : width // 2 * 2]
    if (width, height) == size:
        return image
    shrinks = size[0] * size[1] < width * height
    scaled: Image = cv2.resize(image, size, interpolation=cv2.INTER_AREA if shrinks else cv2.INTER_LINEAR)
    return scaled
