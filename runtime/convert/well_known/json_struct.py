"""google.protobuf.Struct to and from a text of JSON that is an object."""

from __future__ import annotations

from google.protobuf.struct_pb2 import Struct

from roverlink.runtime.convert.well_known.json_text import plain_struct, text_of, value_of
from roverlink.runtime.core.errors import ConversionError


def to_ros(payload: Struct, field: str) -> str:
    """The text that says what the payload says. Raises `ConversionError` where no JSON can."""
    return text_of(plain_struct, payload, field)


def from_ros(text: str, field: str) -> Struct:
    """The payload that says what the text says. Raises `ConversionError` where that is no object."""
    value = value_of(text, field)
    if not value.HasField("struct_value"):
        raise ConversionError("is JSON, but no object", field)
    return value.struct_value
