"""Images in ROS 2 messages as arrays."""

from __future__ import annotations

import struct
from typing import Any

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from roverkit.vision.ros.image_messages import ImageMessage, read_image

from rover.tests.vision.ros_images import FRAME, header, image
from roverlink.runtime import ConversionError
from roverlink.runtime.core import cdr
from roverlink.runtime.interfaces.sensor_msgs import CompressedImage, Image

_RNG = np.random.default_rng(5)
_COLOURS = _RNG.integers(0, 256, (4, 6, 3), np.uint8)
_GREYS = _RNG.integers(0, 256, (4, 6), np.uint8)
_BGR = (40, 130, 220)


def _read(message: Image | CompressedImage) -> ImageMessage:
    return read_image(type(message), cdr.encode(message))


def _wide(pixels: NDArray[Any]) -> NDArray[np.uint16]:
    """The same brightness with 16 bits."""
    return pixels.astype(np.uint16) * 257


@pytest.mark.parametrize(
    ("encoding", "pixels", "expected"),
    [
        ("bgr8", _COLOURS, _COLOURS),
        ("8UC3", _COLOURS, _COLOURS),
        ("rgb8", _COLOURS[:, :, ::-1], _COLOURS),
        ("bgra8", np.dstack([_COLOURS, _GREYS]), _COLOURS),
        ("rgba8", np.dstack([_COLOURS[:, :, ::-1], _GREYS]), _COLOURS),
        ("bgr16", _wide(_COLOURS), _COLOURS),
        ("rgb16", _wide(_COLOURS[:, :, ::-1]), _COLOURS),
        ("mono8", _GREYS, _GREYS),
        ("8UC1", _GREYS, _GREYS),
        ("mono16", _wide(_GREYS), _GREYS),
    ],
)
@pytest.mark.parametrize("padding", [0, 2, 6])
def test_every_encoding_gives_its_picture(
    encoding: str, pixels: NDArray[Any], expected: NDArray[Any], padding: int
) -> None:
    """Colours come as BGR and greys as they are, with 8 bits, whatever stands behind each row."""
    read = _read(image(pixels, encoding, stamp=7_000_000_008, padding=padding))
    assert (read.stamp, read.frame_id, read.encoding) == (7_000_000_008, FRAME, encoding)
    assert np.array_equal(read.image(), expected)


@pytest.mark.parametrize("pattern", ["rggb", "bggr", "gbrg", "grbg"])
def test_a_bayer_pattern_gives_the_colour(pattern: str) -> None:
    """A wall of one colour has this colour behind each order of the filters, with 8 and with 16 bits."""
    tile = np.array([_BGR["bgr".index(letter)] for letter in pattern], np.uint8).reshape(2, 2)
    mosaic = np.tile(tile, (4, 4))
    for pixels, bits in ((mosaic, 8), (_wide(mosaic), 16)):
        assert (_read(image(pixels, f"bayer_{pattern}{bits}")).image()[2:-2, 2:-2] == _BGR).all()


@pytest.mark.parametrize(
    ("encodings", "order"), [(("yuv422", "uyvy"), (1, 0, 3, 2)), (("yuv422_yuy2", "yuyv"), (0, 1, 2, 3))]
)
def test_yuv_gives_the_colour(encodings: tuple[str, str], order: tuple[int, ...]) -> None:
    """A pair of pixels has two values of brightness (BT.601) and one colour, in either order of the bytes."""
    # y0 u y1 v: white and black; then red twice
    pairs = np.array([[235, 128, 16, 128], [81, 90, 81, 240]], np.uint8)[:, order]
    for encoding in encodings:
        picture = _read(image(pairs.reshape(1, 4, 2), encoding)).image()
        assert np.abs(picture[0].astype(int) - [[255] * 3, [0] * 3, [0, 0, 255], [0, 0, 255]]).max() <= 2


@pytest.mark.parametrize(
    ("encoding", "pixels"),
    [("16UC1", np.array([[0, 1234]], np.uint16)), ("32FC1", np.array([[np.nan, 1.234]], np.float32))],
)
def test_a_depth_is_in_metres(encoding: str, pixels: NDArray[Any]) -> None:
    """Where it is missing, it is 0 or NaN, as the driver has it. Big-endian machines are understood."""
    for values in (pixels, pixels.astype(pixels.dtype.newbyteorder())):
        depth = _read(image(values, encoding, is_bigendian=int(values is not pixels))).depth()
        assert depth.dtype == np.float32
        assert not depth[0, 0] > 0
        assert depth[0, 1] == np.float32(1.234)


def test_a_picture_is_no_depth() -> None:
    """And a depth is no picture: the message names the encoding, and what to do."""
    with pytest.raises(ConversionError, match="the encoding mono8 shows no depths; name the topic of a depth image"):
        _read(image(_GREYS, "mono8")).depth()
    with pytest.raises(ConversionError, match=r"16UC1 shows depths; name the topic of a colour or grey image"):
        _read(image(_wide(_GREYS), "16UC1")).image()


@pytest.mark.parametrize(
    ("message", "expected"),
    [
        (image(_COLOURS, "rgb"), "unknown image encoding 'rgb'; did you mean 'rgb8'"),
        (image(_COLOURS, "bgr8", step=17), "an image of 6x4 pixels of bgr8 needs 18 bytes a row, but its step is 17"),
        (image(_COLOURS, "bgr8", height=5), "with a step of 18 needs 90 bytes, but has 72"),
        (image(_COLOURS, "bgr8", height=0), "the image is empty: 6x0 pixels"),
        (image(_COLOURS, "bgr8", height=2**32 - 1, width=2**32 - 1), "needs 12884901885 bytes a row"),
        (image(_COLOURS[:, :5, :2], "yuv422"), "the width of an image of 5x4 pixels of yuv422 is odd"),
        (CompressedImage(header(1), "jpeg", b""), "'jpeg' cannot be read as JPEG or PNG"),
        (CompressedImage(header(1), "jpeg", bytes(100)), "'jpeg' cannot be read as JPEG or PNG"),
        (CompressedImage(header(1), "16UC1; compressedDepth png", bytes(11)), "of 11 bytes is truncated"),
        (CompressedImage(header(1), "16UC1; compressedDepth rvl", bytes(99)), "cannot be read as JPEG or PNG"),
        (CompressedImage(header(1), "rgb8; compressedDepth png", bytes(99)), "unknown encoding 'rgb8' of a comp"),
    ],
)
def test_what_cannot_be_an_image_is_told(message: Image | CompressedImage, expected: str) -> None:
    """Sizes that contradict each other, unknown encodings and damaged data each have their error."""
    with pytest.raises(ConversionError, match=expected):
        _read(message)


@settings(max_examples=50)
@given(st.sampled_from(["raw", "jpeg", "png"]), st.floats(0, 0.999))
def test_a_truncated_message_is_refused(kind: str, part: float) -> None:
    """Wherever it ends, the error is ours."""
    message = image(_COLOURS) if kind == "raw" else _compressed(f".{kind}", _COLOURS, kind)
    data = cdr.encode(message)
    with pytest.raises(ConversionError):
        read_image(type(message), data[: int(part * len(data))])


def _compressed(suffix: str, pixels: NDArray[Any], format: str, prefix: bytes = b"") -> CompressedImage:
    return CompressedImage(header(9), format, prefix + cv2.imencode(suffix, pixels)[1].tobytes())


@pytest.mark.parametrize("format", ["png", "rgb8; png compressed bgr8"])
@pytest.mark.parametrize("pixels", [_COLOURS, _GREYS])
def test_a_png_is_read(format: str, pixels: NDArray[Any]) -> None:
    """Colours and greys come as they were, with either spelling of the format."""
    read = _read(_compressed(".png", pixels, format))
    assert (read.stamp, read.frame_id) == (9, FRAME)
    assert np.array_equal(read.image(), pixels)


def test_a_jpeg_is_read_if_it_is_whole() -> None:
    """A smooth image is nearly the same, also with zeros behind it; the rest of a truncated one would be grey."""
    smooth = cv2.resize(_COLOURS, (96, 64), interpolation=cv2.INTER_CUBIC)
    message = _compressed(".jpg", smooth, "jpeg")
    whole = message.data
    message.data = whole + bytes(100)
    assert np.abs(_read(message).image().astype(int) - smooth).mean() < 5
    message.data = whole[:-100]
    with pytest.raises(ConversionError, match="the JPEG image is truncated"):
        _read(message)


def test_a_compressed_depth_is_read() -> None:
    """Millimetres are in the PNG as they are; metres as their inverse, and 0 for no depth."""
    millimetres = _RNG.integers(0, 5000, (4, 6), np.uint16)
    plain = _read(_compressed(".png", millimetres, "16UC1; compressedDepth png", struct.pack("<iff", 0, 0, 0)))
    assert (plain.encoding, plain.pixels.tolist()) == ("16UC1", millimetres.tolist())
    inverse = np.array([[0, 1000, 2000]], np.uint16)
    read = _read(_compressed(".png", inverse, "32FC1; compressedDepth", struct.pack("<iff", 1, 4000.0, -1000.0)))
    assert read.encoding == "32FC1"
    assert np.allclose(read.pixels, [[np.nan, 2.0, 4000 / 3000]], equal_nan=True)
