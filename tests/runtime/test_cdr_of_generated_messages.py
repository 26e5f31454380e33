"""Every generated message, both ways, against an independent implementation that reads the generated .msg files."""

from __future__ import annotations

from typing import Any

import oracle
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from strategies import messages, payloads

from generated import messages as generated_messages
from generated.registry import REGISTRY
from roverlink.runtime import ConversionError
from roverlink.runtime.core import cdr
from roverlink.runtime.core.messages import Message, fields_of

_HANDLERS = pytest.mark.parametrize("handler", REGISTRY.handlers, ids=lambda handler: handler.route.name)
_MESSAGE_TYPES: list[type[Message]] = [getattr(generated_messages, name) for name in generated_messages.__all__]
_EXAMPLES = settings(max_examples=15)


@_HANDLERS
@_EXAMPLES
@given(data=st.data())
def test_payload_to_cdr(handler: Any, data: st.DataObject) -> None:
    """Each way from a payload to serialized bytes gives what the independent implementation gives."""
    payload = data.draw(payloads(handler.payload_type, sparse=data.draw(st.booleans())))
    message = handler.to_ros(payload)
    expected = oracle.serialize(message)
    assert handler.to_cdr(payload) == expected
    assert cdr.encode(message) == expected


@_HANDLERS
@_EXAMPLES
@given(data=st.data(), slack=st.binary(max_size=8))
def test_cdr_to_payload(handler: Any, data: st.DataObject, slack: bytes) -> None:
    """What the independent implementation wrote, in either byte order, with slack behind it, is the payload again."""
    payload = data.draw(payloads(handler.payload_type))
    message = handler.to_ros(payload)
    for little_endian in (True, False):
        serialized = oracle.serialize(message, little_endian=little_endian)
        assert handler.from_cdr(serialized).SerializeToString() == payload.SerializeToString()
        assert handler.from_cdr(serialized + slack).SerializeToString() == payload.SerializeToString()


@_HANDLERS
@given(data=st.data())
@settings(max_examples=3)
def test_a_message_cut_short_is_refused(handler: Any, data: st.DataObject) -> None:
    """Cut at any byte, a serialized message is a `ConversionError` that names the row, and nothing else."""
    serialized = handler.to_cdr(data.draw(payloads(handler.payload_type)))
    for size in range(len(serialized)):
        with pytest.raises(ConversionError, match=f"^{handler.route.name}: "):
            handler.from_cdr(serialized[:size])


@pytest.mark.parametrize("message_type", _MESSAGE_TYPES, ids=lambda message_type: message_type.__name__)
def test_class_and_msg_file_agree(message_type: type[Message]) -> None:
    """A generated class has the fields, in order, and the constants of its .msg file."""
    assert [field.name for field in fields_of(message_type)] == oracle.field_names(message_type)
    expected = oracle.constants(message_type)
    assert {name: getattr(message_type, name) for name in expected} == expected
    own = {name for name in vars(message_type) if name.isupper()}
    assert own == set(expected)


@pytest.mark.parametrize("message_type", _MESSAGE_TYPES, ids=lambda message_type: message_type.__name__)
@_EXAMPLES
@given(data=st.data())
def test_any_message_both_ways(message_type: type[Message], data: st.DataObject) -> None:
    """Messages with any values, not only those that payloads have, are written and read as the other one does it."""
    message = data.draw(messages(message_type))
    expected = oracle.serialize(message)
    assert cdr.encode(message) == expected
    assert cdr.encode(cdr.decode(message_type, expected)) == expected
    assert cdr.encode(cdr.decode(message_type, oracle.serialize(message, little_endian=False))) == expected


@_HANDLERS
def test_help_shows_what_a_program_uses(handler: Any) -> None:
    """A generated handler has no public name beside its row, its two types and its conversions."""
    public = {name for name in dir(handler) if not name.startswith("_")}
    assert public == {"route", "payload_type", "message_type", "to_ros", "from_ros", "to_cdr", "from_cdr"}


@_HANDLERS
def test_an_enum_value_that_does_not_fit_names_route_and_field(handler: Any) -> None:
    """A value beyond the integer that holds its enum is refused with the path of the field, never cut off."""
    for field in handler.payload_type.DESCRIPTOR.fields:
        if field.enum_type is None:
            continue
        for value in (-1, 300):
            payload = handler.payload_type(**{field.name: value})
            with pytest.raises(ConversionError, match=rf"^{handler.route.name}\.{field.name}.*: {value} does not fit"):
                handler.to_cdr(payload)
