"""Conversion of google.protobuf.ListValue to a string with a JSON array, and back."""

from __future__ import annotations

from google.protobuf.struct_pb2 import ListValue

from roverlink.runtime.convert.well_known.json_text import plain_list, text_of, value_of
from roverlink.runtime.core.errors import ConversionError


def to_ros(payload: ListValue, field: str) -> str:
    """Return a ListValue as JSON text. Raises `ConversionError` if JSON cannot hold one of its values."""
    return text_of(plain_list, payload, field)


def from_ros(text: str, field: str) -> ListValue:
    """Parse JSON text to a ListValue. Raises `ConversionError` if the text is not a JSON array."""
    value = value_of(text, field)
    if not value.HasField("list_value"):
        raise ConversionError("is JSON, but not an array", field)
    return value.list_value
