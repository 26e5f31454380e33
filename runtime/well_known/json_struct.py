"""google.protobuf.Struct to and from a text of JSON that is an object."""

from __future__ import annotations

from google.protobuf.struct_pb2 import Struct

from runtime.errors import ConversionError
from runtime.well_known.json_text import built, parsed, plain_struct, struct_of, text_of


def to_ros(payload: Struct, field: str) -> str:
    """The text that says what the payload says. Raises `ConversionError` where no JSON can."""
    return text_of(plain_struct, payload, field)


def from_ros(text: str, field: str) -> Struct:
    """The payload that says what the text says. Raises `ConversionError` where that is no object."""
    said = parsed(text, field)
    if not isinstance(said, dict):
        raise ConversionError("is JSON, but no object", field)
    return built(struct_of, said, field)
