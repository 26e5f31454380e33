"""Classes of the generated messages, beside the generated .msg files, which an independent implementation reads."""

from __future__ import annotations

import oracle
import pytest

from generated import messages as generated_messages
from roverlink.runtime.core.messages import Message, fields_of

_MESSAGE_TYPES: list[type[Message]] = [getattr(generated_messages, name) for name in generated_messages.__all__]


@pytest.mark.parametrize("message_type", _MESSAGE_TYPES, ids=lambda message_type: message_type.__name__)
def test_class_and_msg_file_agree(message_type: type[Message]) -> None:
    """A generated class has the fields, in order, and the constants of its .msg file."""
    assert [field.name for field in fields_of(message_type)] == oracle.field_names(message_type)
    expected = oracle.constants(message_type)
    assert {name: getattr(message_type, name) for name in expected} == expected
    own = {name for name in vars(message_type) if name.isupper()}
    assert own == set(expected)
