"""Plausible payloads of any type: what the demo sends."""

from __future__ import annotations

from google.protobuf.descriptor_pb2 import DescriptorProto
from google.protobuf.struct_pb2 import ListValue, Struct, Value
from google.protobuf.type_pb2 import Option

from roverlink.generator.example_payloads import payload_at


def test_messages_that_hold_themselves_come_to_an_end() -> None:
    """A type stands in itself no second time; maps are empty."""
    assert payload_at(DescriptorProto, 1.0).field
    assert not payload_at(DescriptorProto, 1.0).nested_type
    assert payload_at(Struct, 1.0) == Struct()
    assert len(payload_at(ListValue, 1.0).values) == 3


def test_members_of_a_oneof_take_turns() -> None:
    """One at a time, each in its second."""
    kinds = [payload_at(Value, float(second)).WhichOneof("kind") for second in range(6)]
    assert len(set(kinds)) == len(Value.DESCRIPTOR.oneofs_by_name["kind"].fields)


def test_an_any_is_empty() -> None:
    """What it may hold is not known from its descriptor."""
    assert not payload_at(Option, 1.0).value.type_url
