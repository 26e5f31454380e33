"""Maps, oneofs and Any: what generated code gets from the runtime."""

from __future__ import annotations

import pytest
from google.protobuf.any_pb2 import Any
from google.protobuf.duration_pb2 import Duration
from google.protobuf.struct_pb2 import Value
from google.protobuf.timestamp_pb2 import Timestamp

from roverlink.runtime.convert import oneof
from roverlink.runtime.convert.any_of import check_empty, check_none, holds, packed, unpacked
from roverlink.runtime.convert.maps import mapping
from roverlink.runtime.core.errors import ConversionError

_MEMBERS = {"number_value": 2, "string_value": 3}


def test_the_member_that_is_set_is_a_number() -> None:
    """Also when it holds its zero value; a member that ROS does not have is none of them."""
    assert oneof.number(Value(), "kind", _MEMBERS) == 0
    assert oneof.number(Value(number_value=0.0), "kind", _MEMBERS) == 2
    assert oneof.number(Value(bool_value=True), "kind", _MEMBERS) == 0


def test_a_number_is_a_member() -> None:
    """0 is none; what stands for no member is refused, with those that there are."""
    assert oneof.member(0, _MEMBERS, "which_kind") is None
    assert oneof.member(3, _MEMBERS, "which_kind") == "string_value"
    with pytest.raises(ConversionError, match=r"which_kind: 7 .* 0 \(none\), 2 \(number_value\), 3 \(string_value\)"):
        oneof.member(7, _MEMBERS, "which_kind")


def test_no_entry_of_a_map_is_lost() -> None:
    """A key that stands twice would hide the first of its values."""
    assert mapping([("a", 1), ("b", 2)], "counts") == {"a": 1, "b": 2}
    with pytest.raises(ConversionError, match=r"^counts: the key 'a' occurs twice"):
        mapping([("a", 1), ("a", 1)], "counts")


def test_an_any_holds_what_it_says() -> None:
    """By the full name after the last slash; without a slash it says nothing."""
    payload = packed(Timestamp(seconds=5))
    assert holds(payload, Timestamp)
    assert not holds(payload, Duration)
    assert unpacked(payload, Timestamp, "content") == Timestamp(seconds=5)
    assert holds(Any(type_url="example.com/of/google.protobuf.Duration"), Duration)
    assert not holds(Any(type_url="google.protobuf.Duration"), Duration)


def test_an_any_of_something_else_is_refused() -> None:
    """A type that is not listed, bytes that are no message, a number that stands for nothing."""
    check_empty(Any(), "Content")
    check_none(0, "Content")
    with pytest.raises(ConversionError, match=r"^Content: .*Timestamp"):
        check_empty(packed(Timestamp()), "Content")
    with pytest.raises(ConversionError, match=r"^Content: "):
        check_empty(Any(value=b"x"), "Content")
    with pytest.raises(ConversionError, match=r"^Content\.time: not a valid google"):
        unpacked(
            Any(type_url="type.googleapis.com/google.protobuf.Timestamp", value=b"\xff"), Timestamp, "Content.time"
        )
    with pytest.raises(ConversionError, match=r"^Content\.which: 9 "):
        check_none(9, "Content")
