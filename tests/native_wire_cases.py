"""Wire cases for the native core, those that protobuf's conformance suite lists, and a project for them."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

from case_file import usual_table

from roverlink.generator.emit.writer import compare, write
from roverlink.generator.pipeline import compile_table
from roverlink.runtime import Registry, load_registry

# A process can load two projects only if no .proto file has the same name.
_TABLE = """
envelope: {file: wire_cases/envelope.proto, message: wire_cases.Envelope, oneof: payload}
python: {package: wire_cases}
messages:
  - {number: 1, name: wire, proto: Wire, topic: wire, direction: board_to_ros}
  - {number: 2, name: required, proto: Required, topic: required, direction: board_to_ros}
  - {number: 3, name: tree, proto: Tree, topic: tree, direction: board_to_ros, ignore: [left, right]}
"""
_PROTO = """edition = "2023";
import "google/protobuf/timestamp.proto";
enum Open { OPEN_ZERO = 0; OPEN_ONE = 1; }
enum Closed { option features.enum_type = CLOSED; ZERO = 0; ONE = 1; }
message Inner { int32 a = 1; string text = 2; repeated int32 list = 3; Deep deep = 4; }
message Deep { int32 x = 1; int32 y = 2; }
message Wire {
  int32 i32 = 1; int64 i64 = 2; uint32 u32 = 3; uint64 u64 = 4; sint32 s32 = 5; sint64 s64 = 6;
  fixed32 f32 = 7; fixed64 f64 = 8; sfixed32 sf32 = 9; sfixed64 sf64 = 10; float real = 11; double wide = 12;
  bool flag = 13; string text = 14; bytes data = 15 [default = "ab"]; Open open = 16; Closed closed = 17;
  Inner inner = 18;
  repeated sint32 expanded = 19 [features.repeated_field_encoding = EXPANDED];
  repeated fixed32 packed = 20; repeated Inner inners = 21; repeated Closed gears = 28; repeated string texts = 29;
  map<string, Inner> map = 22;
  oneof one { int32 chosen = 23; Inner message = 24; string word = 25; }
  Inner part = 26 [features.message_encoding = DELIMITED];
  int32 plain = 27 [features.field_presence = IMPLICIT];
  google.protobuf.Timestamp stamp = 30;
  int32 last = 536870911;
}
message Required { int32 needed = 1 [features.field_presence = LEGACY_REQUIRED]; int32 other = 2; }
"""
_OLD = """syntax = "proto2";
message Tree { optional int32 value = 1; optional Tree left = 2; repeated Tree right = 3; extensions 100 to 200; }
extend Tree { optional string note = 100; }
"""


def _varint(value: int, size: int = 0) -> bytes:
    """A varint, padded to a number of bytes as encoders with a fixed room for it do."""
    groups = [value >> shift & 0x7F for shift in range(0, max(1, value.bit_length()), 7)]
    groups += [0] * (size - len(groups))
    return bytes([*(group | 0x80 for group in groups[:-1]), groups[-1]])


def field(number: int, value: Any, wire: int = 0, tag: int = 0) -> bytes:
    """A field: bytes with their length, an integer as a varint; ``tag`` is the padded size of its tag."""
    head = _varint(number << 3 | (2 if isinstance(value, bytes) else wire), tag)
    return head + (_varint(len(value)) + value if isinstance(value, bytes) else _varint(value))


def _group(number: int, body: bytes, end: int | None = None) -> bytes:
    return _varint(number << 3 | 3) + body + _varint((number if end is None else end) << 3 | 4)


def _entry(key: bytes, value: bytes) -> bytes:
    return field(22, field(1, key) + field(2, value))


_MINUS_ONE = 2**64 - 1
_UNKNOWN = 1000
ACCEPTED = {
    "nothing": b"",
    "a field twice: the last one counts": field(1, 1) + field(1, 2),
    "a negative int32 in ten bytes": field(1, _MINUS_ONE),
    "a negative int32 in five bytes": field(1, 0xFFFFFFFF),
    "an int32 of 64 bits is cut": field(1, 2**33 + 5) + field(3, 2**40 + 7),
    "a bool of 64 bits": field(13, 2**40),
    "a bool of two": field(13, 2),
    "an overlong bool": _varint(13 << 3) + _varint(1, 10),
    "an overlong varint": _varint(1 << 3) + _varint(5, 10),
    "an overlong varint of zero": _varint(2 << 3) + _varint(0, 10),
    "an overlong tag": field(1, 7, tag=5),
    "an overlong length": _varint(14 << 3 | 2) + _varint(2, 5) + b"ok",
    "zigzag of the least": field(5, 2**32 - 1) + field(6, _MINUS_ONE),
    "fixed sizes": b"".join(
        _varint(number << 3 | wire) + struct.pack(form, value)
        for number, wire, form, value in [
            *((7, 5, "<I", 2**32 - 1), (8, 1, "<Q", _MINUS_ONE), (9, 5, "<i", -(2**31)), (10, 1, "<q", -(2**63))),
            *((11, 5, "<f", -0.0), (12, 1, "<d", 5e-324)),
        ]
    ),
    "a NaN": _varint(11 << 3 | 5) + bytes.fromhex("0100c07f"),
    "a signalling NaN": _varint(11 << 3 | 5) + bytes.fromhex("0100a07f"),
    "an empty text": field(14, b""),
    "a text of UTF-8": field(14, "é€😀".encode()),
    "an enum's number that is not declared": field(16, 77),
    "packed though it is expanded": field(19, b"\x01\x02\x03"),
    "expanded though it is packed": (_varint(20 << 3 | 5) + b"\1\0\0\0") * 2,
    "packed and expanded by turns": field(19, b"\x01\x02") + field(19, 3) + field(19, b"") + field(19, b"\x04"),
    "an empty packed list": field(20, b""),
    "another wire type is an unknown field": field(1, b"x") + _varint(14 << 3 | 5) + b"\0\0\0\0" + field(18, 1),
    "a wire type that no list has": _varint(19 << 3 | 1) + bytes(8) + _varint(20 << 3) + b"\5",
    "unknown fields of each wire type": field(_UNKNOWN, 1)
    + _varint(_UNKNOWN << 3 | 1) + bytes(8) + field(_UNKNOWN, b"abc") + _varint(_UNKNOWN << 3 | 5) + bytes(4),
    "an unknown group": _group(_UNKNOWN, field(1, 2) + field(3, b"xyz")) + field(1, 9),
    "unknown groups in unknown groups": _group(7, _group(8, _group(9, b"") + field(1, 1)) + field(2, b"")),
    "a group in place of a message": _group(18, field(1, 2)) + field(1, 3),
    "a delimited message": _group(26, field(1, 2) + field(2, b"in")) + field(1, 3),
    "a delimited message with its length": field(26, field(1, 2)),
    "delimited messages are merged": _group(26, field(1, 2)) + _group(26, field(2, b"in") + field(3, b"\1\2")),
    "messages are merged": field(18, field(1, 2) + field(3, b"\1")) + field(18, field(2, b"x") + field(3, 2)),
    "messages in messages are merged": field(18, field(4, field(1, 2))) + field(18, field(4, field(2, 3))),
    "elements of a list are not merged": field(21, field(1, 2)) + field(21, b"") + field(21, field(2, b"x")),
    "an empty message": field(18, b""),
    "a message of unknown fields": field(18, field(_UNKNOWN, b"abc") + field(1, 4)),
    "a oneof: the last member counts": field(23, 1) + field(25, b"word"),
    "a oneof: a member of zero": field(25, b"word") + field(23, 0),
    "a oneof: messages of one member are merged": field(24, field(1, 2)) + field(24, field(2, b"x")),
    "a oneof: another member between": field(24, field(1, 2)) + field(23, 1) + field(24, field(2, b"x")),
    "a oneof: a member of another wire type": field(23, 1) + field(25, 4),
    "a map": _entry(b"b", field(1, 2)) + field(22, field(1, b"a")),
    "a map: the last entry of a key counts": _entry(b"k", field(1, 1)) + _entry(b"a", b"") + _entry(b"k", b""),
    "a map: an entry without key and value": field(22, b""),
    "a map: the value before the key": field(22, field(2, field(1, 2)) + field(1, b"k")),
    "a map: the key twice": field(22, field(1, b"x") + field(2, field(1, 1)) + field(1, b"k")),
    "a map: the value twice": field(22, field(2, field(1, 1)) + field(2, field(2, b"t"))),
    "a field that is zero": field(27, 0) + field(1, 0),
    "the largest field number": field(536870911, 5) + field(536870910, 6),
    "fields in any order": field(27, 1) + field(18, b"") + field(1, 2) + field(14, b"t"),
    "a time": field(30, field(1, 5) + field(2, 999_999_999)) + field(30, field(1, 6)),
}  # fmt: skip
HANDED_OVER = {
    "field 0": field(0, 1),
    "field 0 with bytes": field(0, b"abc"),
    "a field number above the largest": _varint(1 << 32 | 8) + b"\0",
    "a tag of six bytes": field(1, 7, tag=6),
    "a tag of eleven bytes": field(1, 7, tag=11),
    "a truncated tag": field(1, 1) + b"\x80",
    "a truncated varint": _varint(1 << 3) + b"\x80",
    "a varint of eleven bytes": _varint(1 << 3) + _varint(5, 11),
    "truncated 32 bits": _varint(7 << 3 | 5) + b"\0\0\0",
    "truncated 64 bits": _varint(8 << 3 | 1) + bytes(7),
    "no value": _varint(1 << 3),
    "a text without a length": _varint(14 << 3 | 2),
    "a length behind the end": _varint(14 << 3 | 2) + b"\5abcd",
    "an oversized length": _varint(14 << 3 | 2) + _varint(2**31) + b"abcd",
    "a length of 64 bits": _varint(14 << 3 | 2) + _varint(_MINUS_ONE),
    "a length of six bytes": _varint(14 << 3 | 2) + _varint(2, 6) + b"ok",
    "a length in a message behind its end": field(18, _varint(2 << 3 | 2) + b"\5abc") + bytes(100),
    "a truncated packed list": field(20, bytes(5)) + field(19, b"\x80"),
    "an unknown field that is truncated": _varint(_UNKNOWN << 3 | 2) + b"\5abc",
    "an unknown field of wire type 6": _varint(_UNKNOWN << 3 | 6) + b"\0",
    "a field of wire type 7": _varint(1 << 3 | 7) + b"\0",
    "a group that does not end": _varint(_UNKNOWN << 3 | 3) + field(1, 1),
    "a group that ends with another number": _group(_UNKNOWN, b"", end=_UNKNOWN + 1),
    "the end of no group": _varint(_UNKNOWN << 3 | 4),
    "the end of a delimited message with another number": _group(26, field(1, 1), end=27),
    "a delimited message that does not end": _varint(26 << 3 | 3) + field(1, 1),
    "the end of a group in a message": field(18, _varint(18 << 3 | 4)),
    "a text that is no UTF-8": field(14, b"\xff"),
    "a text with a surrogate": field(14, b"\xed\xa0\x80"),
    "a text with an overlong character": field(14, b"\xc0\x80"),
    "a text with a truncated character": field(14, b"\xe2\x82"),
    "a text of a oneof that is no UTF-8": field(25, b"\x80") + field(23, 1),
    "a key that is no UTF-8": field(22, field(1, b"\xff")),
    "an unused text that is no UTF-8": field(18, field(2, b"\xf5\x80\x80\x80")),
    "a thousand groups": _varint(_UNKNOWN << 3 | 3) * 1000 + _varint(_UNKNOWN << 3 | 4) * 1000,
}
OTHERS = {
    "a map: an unknown field in an entry": field(22, field(1, b"x") + field(3, 5)),
    "a map: a key of another wire type": field(22, field(1, b"x") + field(1, 5)),
    "an enum's number that the ROS field does not hold": field(16, _MINUS_ONE),
    "a closed enum's number that is not declared": field(17, 1) + field(17, 5),
    "the same in a list": field(28, b"\0\1\5\1"),
    "a text with a NUL": field(14, b"a\0b"),
    "a time of too many nanoseconds": field(30, field(2, 1_000_000_000)),
}
"""What protobuf accepts, and the core may hand over: the handler refuses it, or it is rare."""


def wire_project(folder: Path) -> Registry:
    """Compile the project of the wire cases, whose row ``wire`` has a field of each kind."""
    (folder / "proto").mkdir()
    (folder / "proto" / "wire_cases.proto").write_text(_PROTO)
    (folder / "proto" / "wire_cases_old.proto").write_text(_OLD)
    (folder / "mapping.yaml").write_text(usual_table(_TABLE))
    compiled = compile_table(folder / "mapping.yaml")
    write(folder, compare(folder, compiled.files, compiled.folders), overwrite=True)
    return load_registry(folder, "wire_cases")
