"""google.protobuf.ListValue to and from a text of JSON that is a list."""

from __future__ import annotations

from google.protobuf.struct_pb2 import ListValue

from roverlink.runtime.convert.well_known.json_text import plain_list, text_of, value_of
from roverlink.runtime.core.errors import ConversionError


def to_ros(payload: ListValue, field: str) -> str:
    """The text that says what the payload says. Raises `ConversionError` where no JSON can."""
    return text_of(plain_list, payload, field)


def from_ros(text: str, field: str) -> ListValue:
    """The payload that says what the text says. Raises `ConversionError` where that is no list."""
    value = value_of(text, field)
    if not value.HasField("list_value"):
        raise ConversionError("is JSON, but no list", field)
    return value.list_value
