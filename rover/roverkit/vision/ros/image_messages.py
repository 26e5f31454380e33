"""Images in ROS 2 messages as numpy arrays: sensor_msgs/Image and sensor_msgs/CompressedImage.

The pixels of an uncompressed image are not copied: the array looks into the bytes of the serialized message.

The names of encodings are those of sensor_msgs/image_encodings.hpp. A CompressedImage has JPEG or PNG data of
compressed_image_transport, or a depth image of compressed_depth_image_transport.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from roverkit.vision.markers.detection import Image
from roverkit.vision.opencv import cv2
from roverlink.numerals import counted
from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import ConversionError, SetupError, nearest
from roverlink.runtime.core.messages import Message
from roverlink.runtime.interfaces import sensor_msgs
from roverlink.runtime.ros_time.headers import header_of, stamp_of

IMAGES: tuple[type[Message], ...] = (sensor_msgs.Image, sensor_msgs.CompressedImage)
"""Message types of which a topic with images can be."""
_QUALITY = 80  # of JPEG


class _Encoding(NamedTuple):
    """Layout of the pixels: type of a channel, number of channels, and OpenCV's conversion to BGR (None: not needed).

    A depth has no conversion.
    """

    type: str
    channels: int
    to_bgr: str | None = None
    is_depth: bool = False


def _bayer(pattern: str, bits: int) -> _Encoding:
    # ROS and this name of OpenCV's both give the upper left four pixels, row by row.
    return _Encoding(f"u{bits // 8}", 1, f"COLOR_Bayer{pattern}2BGR")


_ENCODINGS = {
    "mono8": _Encoding("u1", 1),
    "8UC1": _Encoding("u1", 1),
    "mono16": _Encoding("u2", 1),
    "bgr8": _Encoding("u1", 3),
    "8UC3": _Encoding("u1", 3),
    "rgb8": _Encoding("u1", 3, "COLOR_RGB2BGR"),
    "bgra8": _Encoding("u1", 4, "COLOR_BGRA2BGR"),
    "rgba8": _Encoding("u1", 4, "COLOR_RGBA2BGR"),
    "bgr16": _Encoding("u2", 3),
    "rgb16": _Encoding("u2", 3, "COLOR_RGB2BGR"),
    # Two names each: image_encodings.hpp has deprecated the older ones.
    "yuv422": _Encoding("u1", 2, "COLOR_YUV2BGR_UYVY"),
    "uyvy": _Encoding("u1", 2, "COLOR_YUV2BGR_UYVY"),
    "yuv422_yuy2": _Encoding("u1", 2, "COLOR_YUV2BGR_YUY2"),
    "yuyv": _Encoding("u1", 2, "COLOR_YUV2BGR_YUY2"),
    **{
        f"bayer_{pattern.lower()}{bits}": _bayer(pattern, bits)
        for pattern in ("RGGB", "BGGR", "GBRG", "GRBG")
        for bits in (8, 16)
    },
    "16UC1": _Encoding("u2", 1, is_depth=True),
    "32FC1": _Encoding("f4", 1, is_depth=True),
}
_PAIRED = 2  # the channels of an encoding whose pixels share their colours in pairs
_MILLIMETRES = np.float32(1000)
_TO_8_BITS = 255 / 65535
_FROM_PNG = {(2, "uint8"): "mono8", (2, "uint16"): "mono16", (3, "uint8"): "bgr8", (3, "uint16"): "bgr16"}
_DEPTH_HEADER = struct.Struct("<i2f")  # ConfigHeader of compressed_depth_image_transport: format, and two parameters
_JPEG, _JPEG_END = b"\xff\xd8", b"\xff\xd9"
_JPEG_TAIL = 4096  # bytes at the end in which the end marker must be; some cameras append zeros


@dataclass(frozen=True, slots=True, eq=False)
class ImageMessage:
    """Image of a ROS 2 message."""

    stamp: int
    """Time of the image in nanoseconds since 1970; 0 if the publisher does not set it."""
    frame_id: str
    """Name of the camera's coordinate frame; empty if the publisher does not set it."""
    encoding: str
    """Name of the encoding, such as ``rgb8``."""
    pixels: NDArray[Any]
    """Read-only array (H, W) or (H, W, channels). A depth is in millimetres (``16UC1``) or metres (``32FC1``)."""

    def image(self) -> Image:
        """Return the image with 8 bits a channel: grey (H, W), or BGR (H, W, 3).

        Images of the encodings ``mono8`` and ``bgr8`` are not copied. Raises `ConversionError` for a depth image.
        """
        encoding = _ENCODINGS[self.encoding]
        if encoding.is_depth:
            raise ConversionError(
                f"an image with the encoding {self.encoding} shows depths; name the topic of a colour or grey image"
            )
        pixels = self.pixels
        if pixels.dtype != np.uint8:
            pixels = cv2.convertScaleAbs(pixels, alpha=_TO_8_BITS)
        return pixels if encoding.to_bgr is None else cv2.cvtColor(pixels, getattr(cv2, encoding.to_bgr))

    def depth(self) -> NDArray[np.float32]:
        """Return the depth (H, W) in metres; NaN or 0 where it is missing.

        Depths of the encoding ``32FC1`` are not copied. Raises `ConversionError` for any other image.
        """
        if not _ENCODINGS[self.encoding].is_depth:
            raise ConversionError(
                f"an image with the encoding {self.encoding} shows no depths; name the topic of a depth image"
            )
        pixels: NDArray[np.float32] = self.pixels.astype(np.float32, copy=False)
        return pixels if self.encoding == "32FC1" else pixels / _MILLIMETRES


def read_image(message_type: type[Message], data: bytes) -> ImageMessage:
    """Return the image of a serialized message; ``message_type`` is one of `IMAGES`.

    Raises `ConversionError` if the message is damaged, its sizes contradict each other, or its encoding is unknown.
    """
    if message_type is sensor_msgs.CompressedImage:
        compressed = cdr.decode(sensor_msgs.CompressedImage, data, views=True)
        header, (encoding, pixels) = compressed.header, _decompressed(compressed)
    else:
        image = cdr.decode(sensor_msgs.Image, data, views=True)
        header, encoding, pixels = image.header, image.encoding, _pixels(image)
    return ImageMessage(stamp_of(header), header.frame_id, encoding, pixels)


def compressed_of(image: Image, stamp: int, frame: str) -> sensor_msgs.CompressedImage:
    """Return a message with an image (H, W, 3) as JPEG. Raises `SetupError` if the image is too large for JPEG."""
    done, data = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, _QUALITY])
    if not done:
        raise SetupError(f"cannot write an image of {image.shape[1]}x{image.shape[0]} pixels as JPEG")
    return sensor_msgs.CompressedImage(header_of(stamp, frame), "jpeg", data.tobytes())


def _pixels(message: sensor_msgs.Image) -> NDArray[Any]:
    """Return the pixels of an image as an array that looks into the message."""
    encoding = _ENCODINGS.get(message.encoding)
    if encoding is None:
        raise ConversionError(f"unknown image encoding {message.encoding!r}; {nearest(message.encoding, _ENCODINGS)}")
    dtype = np.dtype(encoding.type).newbyteorder(">" if message.is_bigendian else "<")
    height, width, step = message.height, message.width, message.step
    row = width * encoding.channels * dtype.itemsize
    size = f"{width}x{height} pixels of {message.encoding}"
    if not row or not height:
        raise ConversionError(f"the image is empty: {size}")
    if step < row:
        raise ConversionError(f"an image of {size} needs {counted(row, 'byte')} a row, but its step is {step}")
    if len(message.data) != height * step:
        raise ConversionError(
            f"an image of {size} with a step of {step} needs {counted(height * step, 'byte')}, but has "
            f"{len(message.data)}"
        )
    if encoding.channels == _PAIRED and width % 2:
        raise ConversionError(f"the width of an image of {size} is odd; two pixels share their colour")
    rows = np.frombuffer(message.data, np.uint8).reshape(height, step)[:, :row]
    # A view changes no byte. Only pixels in the foreign byte order have to be copied, because OpenCV cannot read them.
    pixels: NDArray[Any] = rows.view(dtype).astype(dtype.newbyteorder("="), copy=False)
    return pixels if encoding.channels == 1 else pixels.reshape(height, width, encoding.channels)


def _decompressed(message: sensor_msgs.CompressedImage) -> tuple[str, NDArray[Any]]:
    """Return the encoding and the pixels of a compressed image.

    Its format is ``jpeg`` or ``png``, or begins with the encoding before the compression: ``16UC1; compressedDepth
    png``.
    """
    encoding, _, transport = message.format.partition(";")
    if "compressedDepth" in transport:
        return encoding, _depth(encoding, message.data)
    if message.data[: len(_JPEG)] == _JPEG and _JPEG_END not in bytes(message.data[-_JPEG_TAIL:]):
        raise ConversionError("the JPEG image is truncated")  # OpenCV would fill the rest with grey
    pixels = _decoded(message.data, message.format)
    # The writer has converted colours to BGR, as OpenCV's encoders need them; only a depth keeps its meaning.
    stored = _FROM_PNG.get((pixels.ndim, pixels.dtype.name))
    if stored is None:
        raise ConversionError(f"the pixels of the compressed image are {pixels.dtype.name}; 8 or 16 bits are known")
    return ("16UC1" if stored == "mono16" and encoding == "16UC1" else stored), pixels


def _depth(encoding: str, data: bytes) -> NDArray[Any]:
    """Return the depths of a compressedDepth image: those of a PNG, or for 32FC1 the inverse of what is in the PNG."""
    if encoding not in ("16UC1", "32FC1"):
        raise ConversionError(f"unknown encoding {encoding!r} of a compressedDepth image (known: 16UC1, 32FC1)")
    if len(data) < _DEPTH_HEADER.size:
        raise ConversionError(f"a compressedDepth image of {counted(len(data), 'byte')} is truncated")
    _, scale, shift = _DEPTH_HEADER.unpack_from(data)
    stored = _decoded(data[_DEPTH_HEADER.size :], f"{encoding}; compressedDepth")
    if stored.dtype != np.uint16 or stored.ndim != 2:
        raise ConversionError("a compressedDepth image must be a PNG with one channel of 16 bits")
    if encoding == "16UC1":
        return stored
    with np.errstate(divide="ignore"):
        depths: NDArray[Any] = np.float32(scale) / (stored.astype(np.float32) - np.float32(shift))
    depths[stored == 0] = np.nan
    return depths


def _decoded(data: bytes, what: str) -> NDArray[Any]:
    flags = cv2.IMREAD_ANYCOLOR | cv2.IMREAD_ANYDEPTH | cv2.IMREAD_IGNORE_ORIENTATION
    try:
        pixels = cv2.imdecode(np.frombuffer(data, np.uint8), flags) if len(data) else None
    except cv2.error as error:
        raise ConversionError(f"a compressed image with the format {what!r} cannot be read: {error.err}") from error
    if pixels is None:
        raise ConversionError(
            f"a compressed image with the format {what!r} cannot be read as JPEG or PNG; it is damaged, or has another "
            "compression"
        )
    found: NDArray[Any] = pixels
    return found
