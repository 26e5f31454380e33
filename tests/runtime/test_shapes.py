"""Shapes that were learned: what is read by them is what protobuf reads, and what they do not cover is left alone."""

from __future__ import annotations

import struct
from collections.abc import Collection
from itertools import combinations
from typing import Any

import pytest
from datagrams import hostile
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from hypothesis import given, settings
from hypothesis import strategies as st
from strategies import delimited, varint

from generated.registry import REGISTRY
from runtime import DatagramError, Translator
from runtime.registry import AnyHandler
from runtime.shapes import MOST, TRIES, Shapes

_FLAT = ("imu_info", "ph_info", "pressure_info", "load_cell_info", "gps_info", "arm_pos", "rock_measure_request")
"""Rows whose payload is nothing but numbers."""
_IMU = REGISTRY.by_name["imu_info"]


def _datagram(handler: AnyHandler, payload: Any) -> bytes:
    return REGISTRY.envelope(**{handler.route.name: payload}).SerializeToString()


def _shapes(*handlers: AnyHandler) -> Shapes:
    return Shapes({handler.route.name: handler.payload_type.DESCRIPTOR for handler in handlers})


def _outcome(translator: Translator, datagram: bytes) -> tuple[str, bytes] | str:
    try:
        return translator.receive(datagram)
    except DatagramError as error:
        return f"{error.reason}: {error}"


def _without_shapes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Shapes, "read", lambda *_: None)


def _alike(handler: AnyHandler, fields: Collection[str]) -> st.SearchStrategy[Any]:
    """Payloads with something in just these fields, and in their integers what a varint of one byte holds."""
    values = {}
    for field in handler.payload_type.DESCRIPTOR.fields:
        if field.name not in fields:
            continue
        if field.cpp_type in (field.CPPTYPE_FLOAT, field.CPPTYPE_DOUBLE):
            width = 32 if field.cpp_type == field.CPPTYPE_FLOAT else 64
            values[field.name] = st.floats(width=width).filter(lambda number: repr(number) != "0.0")  # type: ignore[call-overload]
        else:
            values[field.name] = st.just(True) if field.cpp_type == field.CPPTYPE_BOOL else st.integers(1, 127)
    return st.fixed_dictionaries(values).map(lambda given: handler.payload_type(**given))


def _values(handler: AnyHandler, payload: Any) -> dict[str, str]:
    """As texts, which tell -0.0 from 0.0, True from 1, and are the same of any nan."""
    return {field.name: repr(getattr(payload, field.name)) for field in handler.payload_type.DESCRIPTOR.fields}


@pytest.mark.parametrize("name", _FLAT)
@settings(max_examples=40, deadline=None)
@given(data=st.data())
def test_what_is_read_by_a_shape_is_what_protobuf_reads(name: str, data: st.DataObject) -> None:
    """Every field has protobuf's value and type, whether it is in the datagram or not, for values not seen before."""
    handler = REGISTRY.by_name[name]
    shapes = _shapes(handler)
    names = [field.name for field in handler.payload_type.DESCRIPTOR.fields]
    alike = _alike(handler, data.draw(st.sets(st.sampled_from(names))))
    first = data.draw(alike)
    shapes.learn(_datagram(handler, first), name, first)
    for payload in data.draw(st.lists(alike, min_size=1, max_size=6)):
        read = shapes.read(_datagram(handler, payload))
        assert read is not None
        assert read[0] == name
        assert _values(handler, read[1]) == _values(handler, payload)


def test_a_shape_is_learned_from_one_datagram_and_read_ever_after() -> None:
    """The next datagram that differs in values alone needs no protobuf."""
    shapes, first = _shapes(_IMU), _IMU.payload_type(accel_x=1.5, mag_z=-0.0, is_calibrated=True, error_code=5)
    datagram = _datagram(_IMU, first)
    assert shapes.read(datagram) is None
    shapes.learn(datagram, "imu_info", first)
    second = _IMU.payload_type(accel_x=float("nan"), mag_z=7.25, is_calibrated=True, error_code=127)
    read = shapes.read(_datagram(_IMU, second))
    assert read is not None
    assert (read[1].mag_z, read[1].is_calibrated, read[1].error_code, read[1].accel_y) == (7.25, True, 127, 0.0)
    assert read[1].accel_x != read[1].accel_x


def test_shapes_change_nothing_of_what_becomes_of_hostile_datagrams(monkeypatch: pytest.MonkeyPatch) -> None:
    """A translator that has learned from thousands answers as one that never learns, whatever is damaged how."""
    datagrams = list(hostile(REGISTRY, 8_000, seed=3))
    learned = Translator(REGISTRY)
    answers = [_outcome(learned, datagram) for datagram in datagrams]
    assert sum(learned._shapes.read(datagram) is not None for datagram in datagrams) > 500
    _without_shapes(monkeypatch)
    never = Translator(REGISTRY)
    assert answers == [_outcome(never, datagram) for datagram in datagrams]


_PLAIN = _IMU.payload_type(accel_x=1.5, error_code=5)
_CONTENT = _PLAIN.SerializeToString()


@pytest.mark.parametrize(
    "datagram",
    [
        delimited(13, _CONTENT) + bytes(3),
        delimited(13, _CONTENT + varint(99 << 3) + varint(7)),
        delimited(13, b"\x0d" + struct.pack("<f", 2.5) + _CONTENT),
        delimited(13, _CONTENT) + delimited(13, _CONTENT),
        delimited(99, b"new") + delimited(13, _CONTENT),
        delimited(13, _CONTENT) + b"\x70\x00",
        delimited(13, _IMU.payload_type(error_code=128).SerializeToString()),
        delimited(13, b"\x70\x85\x00"),
        delimited(13, b"\x8d\x00" + struct.pack("<f", 2.5)),
        b"\xea\x00" + varint(len(_CONTENT)) + _CONTENT,
        b"\x6a" + bytes([len(_CONTENT) | 0x80, 0]) + _CONTENT,
    ],
    ids=[
        "padded",
        "unknown field",
        "field twice",
        "payload twice",
        "two payloads",
        "a number of the payload's beside it",
        "long varint",
        "overlong varint",
        "overlong tag",
        "overlong tag of the payload",
        "overlong length",
    ],
)
def test_what_a_shape_cannot_say_is_left_to_protobuf(datagram: bytes) -> None:
    """Nothing is learned from it, however often it comes."""
    shapes, payload = _shapes(_IMU), Translator(REGISTRY).parse(datagram)
    for _ in range(3):
        shapes.learn(datagram, "imu_info", payload.imu_info)
        assert shapes.read(datagram) is None


def test_a_datagram_that_protobuf_reads_otherwise_is_not_learned() -> None:
    """What is learned was compared with protobuf's reading, value by value."""
    shapes = _shapes(_IMU)
    shapes.learn(_datagram(_IMU, _PLAIN), "imu_info", _IMU.payload_type(accel_x=-1.5, error_code=5))
    assert shapes.read(_datagram(_IMU, _PLAIN)) is None


@pytest.mark.parametrize("name", ["drive_diag", "arm_diag", "detected_object"])
def test_payloads_with_parts_are_left_to_protobuf(name: str) -> None:
    """A message inside has presence and fields of its own."""
    handler = REGISTRY.by_name[name]
    shapes, payload = _shapes(handler), handler.payload_type()
    shapes.learn(_datagram(handler, payload), name, payload)
    assert shapes.read(_datagram(handler, payload)) is None


@pytest.mark.parametrize(
    "field",
    [
        {"name": "class"},
        {"name": "_hidden"},
        {"name": "x", "label": 3},
        {"name": "x", "type": 9},
        {"name": "x", "type": 17},
        {"name": "x", "proto3_optional": True, "oneof_index": 0},
        {"name": "x", "syntax": "proto2"},
    ],
    ids=["keyword", "underscore", "repeated", "string", "zigzag", "optional", "proto2"],
)
def test_fields_that_are_no_plain_number_are_left_to_protobuf(field: dict[str, Any]) -> None:
    """Neither lists, texts and presence, nor names that a tuple's field cannot have."""
    file = descriptor_pb2.FileDescriptorProto(name="odd.proto", syntax=field.pop("syntax", "proto3"))
    odd = file.message_type.add(name="Odd")
    odd.field.add(**{"number": 1, "label": 1, "type": 5} | field)
    if "oneof_index" in field:
        odd.oneof_decl.add(name="_x")
    envelope = file.message_type.add(name="Envelope")
    envelope.field.add(name="odd", number=13, label=1, type=11, type_name=".Odd")
    pool = descriptor_pool.DescriptorPool()
    pool.Add(file)
    message = message_factory.GetMessageClass(pool.FindMessageTypeByName("Odd"))()
    shapes = Shapes({"odd": message.DESCRIPTOR})
    shapes.learn(delimited(13, b""), "odd", message)
    assert shapes.read(delimited(13, b"")) is None


_AXES = [f"{kind}_{axis}" for kind in ("accel", "gyro", "mag") for axis in "xyz"]


def test_no_more_is_tried_than_is_worth_it() -> None:
    """Datagrams of one length whose fields are always others are learned from a few times, then read by protobuf."""
    shapes = _shapes(_IMU)
    for axis in _AXES:
        payload = _IMU.payload_type(**{axis: 1.0})
        shapes.learn(_datagram(_IMU, payload), "imu_info", payload)
    known = [shapes.read(_datagram(_IMU, _IMU.payload_type(**{axis: 2.0}))) is not None for axis in _AXES]
    assert known == [True] * TRIES + [False]


def test_shapes_need_bounded_memory() -> None:
    """However many datagrams differ in length and fields, of each row so many shapes are kept; others have theirs."""
    pressure = REGISTRY.by_name["pressure_info"]
    shapes = _shapes(_IMU, pressure)
    for count in range(len(_AXES)):
        for axes in combinations(_AXES, count):
            for more in ({}, {"error_code": 1}, {"is_calibrated": True}):
                payload = _IMU.payload_type(**dict.fromkeys(axes, 1.0), **more)
                shapes.learn(_datagram(_IMU, payload), "imu_info", payload)
    assert sum(map(len, shapes._by_start.values())) == MOST
    assert shapes._tries.total() <= MOST + len(shapes._tries)
    payload = pressure.payload_type(pressure_kpa=2.5)
    shapes.learn(_datagram(pressure, payload), "pressure_info", payload)
    assert shapes.read(_datagram(pressure, payload)) is not None
