"""google.protobuf.Value to and from a text of JSON."""

from __future__ import annotations

from google.protobuf.struct_pb2 import Value

from roverlink.runtime.convert.well_known.json_text import plain, text_of, value_of


def to_ros(payload: Value, field: str) -> str:
    """The text that says what the payload says. Raises `ConversionError` where no JSON can."""
    return text_of(plain, payload, field)


def from_ros(text: str, field: str) -> Value:
    """The payload that says what the text says. Raises `ConversionError` where that is nothing."""
    return value_of(text, field)
