"""Conversion of google.protobuf.Struct to a string with a JSON object, and back."""

from __future__ import annotations

from google.protobuf.struct_pb2 import Struct

from roverlink.runtime.convert.well_known.json_text import plain_struct, text_of, value_of
from roverlink.runtime.core.errors import ConversionError


def to_ros(payload: Struct, field: str) -> str:
    """Return a Struct as JSON text. Raises `ConversionError` if JSON cannot hold one of its values."""
    return text_of(plain_struct, payload, field)


def from_ros(text: str, field: str) -> Struct:
    """Parse JSON text to a Struct. Raises `ConversionError` if the text is not a JSON object."""
    value = value_of(text, field)
    if not value.HasField("struct_value"):
        raise ConversionError("is JSON, but not an object", field)
    return value.struct_value
