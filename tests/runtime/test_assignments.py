"""Payloads from `field=value`, as `roverlink send` takes them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import pytest
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

from roverlink.runtime import ConversionError
from roverlink.runtime.text.assignments import payload_from_assignments

if TYPE_CHECKING:
    from google.protobuf.message import Message as ProtoMessage

_FIELD = descriptor_pb2.FieldDescriptorProto
_SCALARS = {
    "a_bool": _FIELD.TYPE_BOOL,
    "a_float": _FIELD.TYPE_FLOAT,
    "a_double": _FIELD.TYPE_DOUBLE,
    "an_int32": _FIELD.TYPE_INT32,
    "a_uint32": _FIELD.TYPE_UINT32,
    "an_int64": _FIELD.TYPE_SINT64,
    "a_uint64": _FIELD.TYPE_FIXED64,
    "a_text": _FIELD.TYPE_STRING,
    "some_bytes": _FIELD.TYPE_BYTES,
}


def _make_type() -> type[ProtoMessage]:
    """A payload with a field of every kind, and names that YAML reads as something else."""
    file = descriptor_pb2.FileDescriptorProto(name="tests/assignments.proto", syntax="proto3")
    part = file.message_type.add(name="Part")
    part.field.add(name="x", number=1, type=_FIELD.TYPE_INT32, label=_FIELD.LABEL_OPTIONAL)
    part.field.add(name="raw", number=2, type=_FIELD.TYPE_BYTES, label=_FIELD.LABEL_OPTIONAL)
    part.field.add(name="mode", number=3, type_name=".Mode", label=_FIELD.LABEL_OPTIONAL)
    part.field.add(name="part", number=4, type_name=".Part", label=_FIELD.LABEL_OPTIONAL)
    mode = file.enum_type.add(name="Mode")
    for number, name in enumerate(["OFF", "ON", "NO", "Y", "_7"]):
        mode.value.add(name=name, number=number)
    whole = file.message_type.add(name="Whole")
    for number, (name, kind) in enumerate(_SCALARS.items(), 1):
        whole.field.add(name=name, number=number, type=kind, label=_FIELD.LABEL_OPTIONAL)
        whole.field.add(name=f"{name}_list", number=number + 20, type=kind, label=_FIELD.LABEL_REPEATED)
    whole.field.add(name="mode", number=50, type_name=".Mode", label=_FIELD.LABEL_OPTIONAL)
    whole.field.add(name="modes", number=51, type_name=".Mode", label=_FIELD.LABEL_REPEATED)
    whole.field.add(name="part", number=52, type_name=".Part", label=_FIELD.LABEL_OPTIONAL)
    whole.field.add(name="parts", number=53, type_name=".Part", label=_FIELD.LABEL_REPEATED)
    pool = descriptor_pool.DescriptorPool()
    pool.Add(file)
    made: type[ProtoMessage] = message_factory.GetMessageClass(pool.FindMessageTypeByName("Whole"))
    return made


_WHOLE = _make_type()


def _made(**assignments: Any) -> Any:
    return payload_from_assignments(_WHOLE, {path.replace("__", "."): value for path, value in assignments.items()})


_VALUES: dict[str, dict[str, Any]] = {
    "a_bool": {"true": True, "off": False},
    "a_float": {"0.5": 0.5, "-9.81": pytest.approx(-9.81), "3": 3.0, "nan": pytest.approx(math.nan, nan_ok=True)},
    "a_double": {"1e-3": 0.001, "1e400": math.inf, "-.inf": -math.inf, "inf": math.inf},
    "an_int32": {"-2147483648": -(2**31), "0x10": 16},
    "a_uint32": {"4294967295": 2**32 - 1},
    "an_int64": {"-9223372036854775808": -(2**63)},
    "a_uint64": {"18446744073709551615": 2**64 - 1},
    "a_text": {text: text for text in ("yes", "007", "", "null", "2024-01-01", "key: [value", "'quoted'")},
    "some_bytes": {"00ff": b"\0\xff", "0010": b"\0\x10", "010203": b"\1\2\3", "1234": b"\x12\x34", "": b""}
    | {"1e10": b"\x1e\x10", "de ad be ef": b"\xde\xad\xbe\xef"},
    "mode": {"ON": 1, "OFF": 0, "NO": 2, "Y": 3, "_7": 4, "3": 3, "77": 77, "-1": -1},
    "an_int32_list": {"[1, -2, 0x3]": [1, -2, 3], "7": [7], "[]": []},
    "a_float_list": {"[1e-3, 2]": [pytest.approx(0.001), 2.0]},
    "a_text_list": {"[yes, 007, 'a, b']": ["yes", "007", "a, b"]},
    "some_bytes_list": {"[0010, ff]": [b"\0\x10", b"\xff"]},
    "modes": {"[ON, OFF, 2]": [1, 0, 2]},
    "a_bool_list": {"[true, no]": [True, False]},
}


@pytest.mark.parametrize(
    ("name", "text", "value"), [(name, *case) for name, cases in _VALUES.items() for case in cases.items()]
)
def test_a_text_is_read_as_its_field_asks(name: str, text: str, value: object) -> None:
    """Numbers are YAML's, bytes hexadecimal, enum values names or numbers, a string is what it is, lists hold these."""
    made = getattr(_made(**{name: text}), name)
    assert (list(made) if name.endswith(("_list", "s")) and name != "some_bytes" else made) == value


def test_nested_fields_are_reached_with_dots_or_as_mappings() -> None:
    """A path with dots, a mapping, and both for different fields, say the same."""
    dotted = _made(part__x="1", part__raw="0010", part__mode="ON", part__part__x="2")
    assert (dotted.part.x, dotted.part.raw, dotted.part.mode, dotted.part.part.x) == (1, b"\0\x10", 1, 2)
    assert _made(part="{x: 1, raw: 0010, mode: ON, part: {x: 2}}") == dotted
    assert _made(part="{x: 1, raw: 0010, mode: ON}", part__part__x="2") == dotted
    assert _made(part={"x": 1, "raw": b"\0\x10", "mode": 1, "part": {"x": 2}}) == dotted


def test_a_list_of_messages_is_a_list_of_mappings() -> None:
    """Repeated messages are given as mappings; an empty mapping is a message that is there, not left out."""
    parts = _made(parts="[{x: 1}, {}, {mode: ON}]").parts
    assert [(part.x, part.mode) for part in parts] == [(1, 0), (0, 0), (0, 1)]
    assert _made(part="{}").HasField("part")
    assert not _made().HasField("part")


@pytest.mark.parametrize(
    ("path", "text", "expected"),
    [
        ("a_flaot", "1", "a_flaot: Whole has no field 'a_flaot'; did you mean 'a_float'?"),
        ("zzzz", "1", "zzzz: Whole has no field 'zzzz'; known: a_bool"),
        ("part.z", "1", "part.z: Part has no field 'z'"),
        ("part.part.z", "1", "part.part.z: Part has no field 'z'"),
        ("a_float.x", "1", "a_float.x: Whole.a_float is not a message, so it has no fields"),
        ("parts.x", "1", "parts.x: Whole.parts is a list; write parts=[{...}, ...]"),
        ("part.", "1", "part.: Part has no field ''"),
        (".x", "1", ".x: Whole has no field ''"),
        *(
            (name, text, f"{name}: {text!r} is not a valid {kind}")
            for name, kind, texts in (
                ("a_bool", "bool", ["1", "maybe"]),
                ("a_float", "float", ["fast", "", "null", "true", "1e39", "2024-13-45", "[1"]),
                ("an_int32", "int32", ["1.5", "true", "2147483648"]),
                ("a_uint32", "uint32", ["-1"]),
                ("an_int64", "sint64", ["9223372036854775808"]),
                ("a_uint64", "fixed64", ["18446744073709551616"]),
            )
            for text in texts
        ),
        ("some_bytes", "xyz", "some_bytes: 'xyz' is not a sequence of bytes in hexadecimal"),
        ("some_bytes", "123", "some_bytes: '123' is not a sequence"),
        ("mode", "ONN", "mode: Mode has no value 'ONN'; did you mean 'ON'?"),
        ("mode", "on", "mode: Mode has no value 'on'"),
        ("mode", "1.5", "mode: Mode has no value '1.5'"),
        ("mode", "2147483648", "mode: Mode has no value '2147483648'"),
        ("modes", "[ON, UP]", "modes[1]: Mode has no value 'UP'"),
        ("an_int32_list", "[1, x]", "an_int32_list[1]: 'x' is not a valid int32"),
        ("an_int32_list", "[1", "an_int32_list: '[1' is not valid YAML"),
        ("part", "3", "part: '3' is not a mapping"),
        ("part", "{y: 3}", "part: Part has no field 'y'"),
        ("part", "{x: far}", "part.x: 'far' is not a valid int32"),
        ("parts", "[{x: 1}, {x: far}]", "parts[1].x: 'far' is not a valid int32"),
        ("parts", "[1]", "parts[0]: '1' is not a mapping"),
    ],
)
def test_what_does_not_fit_is_told_with_its_path(path: str, text: str, expected: str) -> None:
    """A wrong path or value is a `ConversionError` that quotes it and names the field, its type, or a near name."""
    with pytest.raises(ConversionError) as caught:
        payload_from_assignments(_WHOLE, {path: text})
    assert expected in str(caught.value)


@pytest.mark.parametrize(
    "assignments",
    [{"part": "{x: 1}", "part.x": "2"}, {"part.x": "2", "part": "{x: 1}"}, {"part.part.x": "2", "part.part": "{x: 1}"}],
)
def test_a_field_that_is_assigned_twice_is_told(assignments: dict[str, str]) -> None:
    """Two values for one field are a mistake, whichever way they are written; neither wins in silence."""
    with pytest.raises(ConversionError, match="assigned more than once"):
        payload_from_assignments(_WHOLE, assignments)
