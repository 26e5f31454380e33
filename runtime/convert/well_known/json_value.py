"""google.protobuf.Value to and from JSON text in a string."""

from __future__ import annotations

from google.protobuf.struct_pb2 import Value

from roverlink.runtime.convert.well_known.json_text import plain, text_of, value_of


def to_ros(payload: Value, field: str) -> str:
    """Convert to JSON text. Raises `ConversionError` if a value has no JSON form."""
    return text_of(plain, payload, field)


def from_ros(text: str, field: str) -> Value:
    """Parse JSON text. Raises `ConversionError` if it is not JSON."""
    return value_of(text, field)
