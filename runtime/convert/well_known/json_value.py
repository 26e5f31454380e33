"""Conversion of google.protobuf.Value to a string with JSON text, and back."""

from __future__ import annotations

from google.protobuf.struct_pb2 import Value

from roverlink.runtime.convert.well_known.json_text import plain, text_of, value_of


def to_ros(payload: Value, field: str) -> str:
    """Return a Value as JSON text. Raises `ConversionError` if JSON cannot hold it."""
    return text_of(plain, payload, field)


def from_ros(text: str, field: str) -> Value:
    """Parse JSON text to a Value. Raises `ConversionError` if the text is not JSON."""
    return value_of(text, field)
