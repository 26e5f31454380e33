"""google.protobuf.Struct to and from a JSON object in a string."""

from __future__ import annotations

from google.protobuf.struct_pb2 import Struct

from roverlink.runtime.convert.well_known.json_text import plain_struct, text_of, value_of
from roverlink.runtime.core.errors import ConversionError


def to_ros(payload: Struct, field: str) -> str:
    """Convert to JSON text. Raises `ConversionError` if a value has no JSON form."""
    return text_of(plain_struct, payload, field)


def from_ros(text: str, field: str) -> Struct:
    """Parse JSON text. Raises `ConversionError` if it is not a JSON object."""
    value = value_of(text, field)
    if not value.HasField("struct_value"):
        raise ConversionError("is JSON, but not an object", field)
    return value.struct_value
