"""The CDR codec over every kind of field that ROS 2 has."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import oracle
import pytest
from hypothesis import given, settings
from rosbags.typesys import Stores, get_typestore
from strategies import messages

from roverlink import standard_types
from roverlink.runtime import ConversionError
from roverlink.runtime.core import cdr
from roverlink.runtime.core.messages import (
    Bool,
    Bound,
    Byte,
    Char,
    Float32,
    Float64,
    Int8,
    Int16,
    Int32,
    Int64,
    Length,
    Message,
    UInt8,
    UInt16,
    UInt32,
    UInt64,
)
from roverlink.runtime.recording.message_definitions import definition_of


@dataclass(slots=True)
class Point(Message):
    """A part of the message below."""

    __msgtype__: ClassVar[str] = "tests/msg/Point"

    valid: Bool = False
    x: Float64 = 0.0


@dataclass(slots=True)
class Everything(Message):
    """Every kind of field, in an order that needs padding everywhere."""

    __msgtype__: ClassVar[str] = "tests/msg/Everything"

    a_bool: Bool = False
    a_float64: Float64 = 0.0
    a_byte: Byte = 0
    a_uint16: UInt16 = 0
    a_char: Char = 0
    a_uint64: UInt64 = 0
    an_int8: Int8 = 0
    an_int32: Int32 = 0
    a_text: str = ""
    an_int64: Int64 = 0
    short_text: Annotated[str, Bound(4)] = ""
    an_int16: Int16 = 0
    a_uint8: UInt8 = 0
    a_uint32: UInt32 = 0
    point: Point = dataclasses.field(default_factory=Point)
    a_float32: Float32 = 0.0
    some_bytes: bytes = b""
    few_bytes: Annotated[bytes, Bound(3)] = b""
    four_bytes: Annotated[bytes, Length(4)] = bytes(4)
    flags: list[Bool] = dataclasses.field(default_factory=list)
    doubles: list[Float64] = dataclasses.field(default_factory=list)
    three_doubles: Annotated[list[Float64], Length(3)] = dataclasses.field(default_factory=lambda: [0.0] * 3)
    few_shorts: Annotated[list[Int16], Bound(2)] = dataclasses.field(default_factory=list)
    texts: list[str] = dataclasses.field(default_factory=list)
    two_texts: Annotated[list[str], Length(2)] = dataclasses.field(default_factory=lambda: [""] * 2)
    short_texts: Annotated[list[Annotated[str, Bound(4)]], Bound(2)] = dataclasses.field(default_factory=list)
    points: list[Point] = dataclasses.field(default_factory=list)
    two_points: Annotated[list[Point], Length(2)] = dataclasses.field(default_factory=lambda: [Point(), Point()])


@pytest.fixture(scope="module", autouse=True)
def _known_to_rosbags() -> None:
    definition = definition_of(Everything)
    assert "string<=4[<=2] short_texts\ntests/Point[] points\ntests/Point[2] two_points\n" in definition
    oracle.register("tests/msg/Everything", definition)


def _round_trip(message: Message) -> None:
    """Written as rosbags writes it, and read back from either byte order with anything behind it."""
    expected = oracle.serialize(message)
    assert cdr.encode(message) == expected
    for data in (expected, oracle.serialize(message, little_endian=False), expected + b"slack"):
        assert cdr.encode(cdr.decode(type(message), data)) == expected


@pytest.mark.slow
@settings(max_examples=30)
@given(messages(Everything))
def test_every_kind_of_field_both_ways(message: Everything) -> None:
    """Primitives, strings, sequences and arrays, bounded or not, nested or not, are as rosbags has them."""
    _round_trip(message)


@pytest.mark.slow
def test_every_standard_message_starts_empty() -> None:
    """Each class that can be made at run time has a default for each field, and it is written and read."""
    names = [name for name in get_typestore(Stores.ROS2_HUMBLE).fielddefs if "/msg/" in name]
    assert len(names) > 100
    for name in names:
        _round_trip(standard_types.message_type(name)())


@given(messages(Everything))
@settings(max_examples=10)
def test_a_variable_message_cut_short_is_refused(message: Everything) -> None:
    """Cut at any byte, a message of variable size is a `ConversionError`, which names its type."""
    data = cdr.encode(message)
    for size in range(len(data)):
        with pytest.raises(ConversionError, match=r"tests/msg/Everything|not plain CDR"):
            cdr.decode(Everything, data[:size])


@pytest.mark.parametrize("header", ["", "00", "000100", "00020000", "00030000", "00060000", "00070000", "01000000"])
def test_other_encapsulations_are_refused(header: str) -> None:
    """Anything but plain CDR 1 is named by its header, not misread."""
    with pytest.raises(ConversionError, match="not plain CDR"):
        cdr.decode(Point, bytes.fromhex(header) + bytes(32) * bool(len(header) == 8))


def test_what_other_writers_say_is_understood_or_refused() -> None:
    """Options in the header, and an empty text without its NUL; but no bytes that are not UTF-8, nor false counts."""
    assert cdr.decode(Point, b"\0\1\0\3" + cdr.encode(Point(True, 1.5))[4:]) == Point(True, 1.5)
    string, empty = (
        standard_types.message_type("std_msgs/msg/String"),
        standard_types.message_type("std_msgs/msg/Empty"),
    )
    assert cdr.decode(string, bytes(1) + b"\1" + bytes(6)) == string()
    with pytest.raises(ConversionError, match="not UTF-8"):
        cdr.decode(string, bytes.fromhex("00010000 02000000 ff00"))
    # A message without fields has the placeholder that ROS 2's IDL gives it.
    assert cdr.encode(empty()) == bytes.fromhex("0001000000")
    assert cdr.decode(empty, bytes.fromhex("0001000000")) == empty()
    for name in ("std_msgs/msg/String", "std_msgs/msg/Float64MultiArray", "tf2_msgs/msg/TFMessage"):
        with pytest.raises(ConversionError, match="too short"):
            cdr.decode(standard_types.message_type(name), b"\0\1\0\0" + b"\xff" * 16)
    with pytest.raises(ConversionError, match="too short"):
        cdr.decode(empty, bytes.fromhex("00010000"))


_WRONG: dict[str, tuple[dict[str, Any], str]] = {
    "a float too large for float32": ({"a_float32": 3.4028235677973366e38}, "a_float32"),
    "an integer too large for float64": ({"a_float64": 10**400}, "a_float64"),
    "an integer below its range": ({"a_uint8": -1}, "a_uint8"),
    "an integer beyond its range": ({"an_int16": 32_768}, "an_int16"),
    "a float for an integer": ({"an_int32": 1.0}, "an_int32"),
    "a text for a bool": ({"a_bool": "false"}, "a_bool"),
    "a number for a text": ({"a_text": 3}, "a_text"),
    "half a character": ({"a_text": "\ud800"}, "a_text"),
    "a NUL in a text": ({"a_text": "a\0b"}, "a_text"),
    "a text that is too long": ({"short_text": "12345"}, "short_text"),
    "a byte beyond its range": ({"some_bytes": [1, 256]}, r"some_bytes\[1\]"),
    "bytes beyond their bound": ({"few_bytes": b"1234"}, "few_bytes"),
    "bytes of another length": ({"four_bytes": b"123"}, "four_bytes"),
    "a text among flags": ({"flags": [True, "no"]}, r"flags\[1\]"),
    "a text among floats": ({"doubles": [1.0, "2"]}, r"doubles\[1\]"),
    "a sequence beyond its bound": ({"few_shorts": [1, 2, 3]}, "few_shorts"),
    "a long text in a sequence": ({"short_texts": ["a", "12345"]}, r"short_texts\[1\]"),
    "a wrong field of a nested message": ({"point": Point(x="1")}, r"point\.x"),  # type: ignore[arg-type]
    "no message": ({"point": None}, "point"),
    "a wrong field in a sequence": ({"points": [Point(), Point(x="1")]}, r"points\[1\]\.x"),  # type: ignore[arg-type]
}


@pytest.mark.parametrize(("values", "path"), _WRONG.values(), ids=_WRONG.keys())
def test_a_value_that_does_not_fit_names_its_field(values: dict[str, Any], path: str) -> None:
    """Nothing is clamped or converted in silence: the error has the path of the field, and its type."""
    with pytest.raises(ConversionError, match=rf"^{path}: .* does not fit ") as caught:
        cdr.encode(Everything(**values))
    assert caught.value.field == path.replace("\\", "")


@pytest.mark.parametrize(("message", "error"), [(Point(valid="yes"), "valid: 'yes'"), (Point(x=None), "x: None")])  # type: ignore[arg-type]
def test_a_wrong_value_of_a_fixed_message_names_its_field(message: Point, error: str) -> None:
    """Messages that are packed in one call explain themselves as well."""
    with pytest.raises(ConversionError, match=f"^{error} does not fit "):
        cdr.encode(message)
