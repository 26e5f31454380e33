"""Every generated message, both ways, against an independent implementation that reads the generated .msg files."""

from __future__ import annotations

from typing import Any

import oracle
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from strategies import payloads

from generated import messages as generated_messages
from generated.registry import REGISTRY
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


@pytest.mark.parametrize("message_type", _MESSAGE_TYPES, ids=lambda message_type: message_type.__name__)
def test_class_and_msg_file_agree(message_type: type[Message]) -> None:
    """A generated class has the fields, in order, and the constants of its .msg file."""
    assert [field.name for field in fields_of(message_type)] == oracle.field_names(message_type)
    expected = oracle.constants(message_type)
    assert {name: getattr(message_type, name) for name in expected} == expected
    own = {name for name in vars(message_type) if name.isupper()}
    assert own == set(expected)
