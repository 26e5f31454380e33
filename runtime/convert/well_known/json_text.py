"""Conversion of google.protobuf.Value, Struct and ListValue to JSON text, and of JSON text to Value, without loss.

Every double keeps its bits. NaN and infinity are refused, because JSON has no number for them (RFC 8259, section 6).
"""

from __future__ import annotations

import json
import math
import reprlib
from collections.abc import Callable
from typing import Any

from google.protobuf.json_format import ParseDict, ParseError
from google.protobuf.struct_pb2 import ListValue, Struct, Value

from roverlink.runtime.core.errors import ConversionError


def text_of(read: Callable[[Any], object], payload: Struct | Value | ListValue, field: str) -> str:
    """Return a payload as JSON text with sorted keys. Raises `ConversionError` if JSON cannot hold a value.

    ``read`` converts the payload to plain Python values.
    """
    try:
        # Keys are sorted: a protobuf map has no order, and equal payloads must give equal messages.
        return json.dumps(read(payload), ensure_ascii=False, sort_keys=True, allow_nan=False)
    except ValueError as error:
        raise ConversionError(f"cannot be JSON: {error}", field) from error


def value_of(text: str, field: str) -> Value:
    """Parse JSON text to a Value.

    Raises `ConversionError` if the text is not JSON, or if a Value cannot hold its content.
    """
    try:
        said = json.loads(
            text, parse_int=_integer, parse_float=_finite, parse_constant=_finite, object_pairs_hook=_without_repetition
        )
        return ParseDict(said, Value())
    except (ValueError, ParseError) as error:
        raise ConversionError(f"is not JSON that a protobuf Value can hold: {error}", field) from error
    except RecursionError as error:
        raise ConversionError("is JSON that is nested too deeply", field) from error


def _finite(text: str) -> float:
    number = float(text)
    if not math.isfinite(number):
        raise ValueError(f"{reprlib.repr(text)} is not a number that a double can hold")
    return number


def _integer(text: str) -> float:
    number = _finite(text)
    if number != int(text):
        raise ValueError(f"{text} cannot be stored as a double exactly; the nearest is {number!r}")
    return number + 0.0  # a float, since ParseDict would make 0 of the integer -0 and lose its sign


def _without_repetition(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    made = dict(pairs)
    if len(made) < len(pairs):
        raise ValueError("a key occurs twice in one object")
    return made


def plain(value: Value) -> object:
    """Return a Value as a plain Python value.

    Raises `ValueError` if the Value has no content: its oneof ``kind`` is not set.
    """
    kind = value.WhichOneof("kind")
    if kind is None:
        raise ValueError("a google.protobuf.Value has no kind set")
    if kind == "struct_value":
        return plain_struct(value.struct_value)
    if kind == "list_value":
        return plain_list(value.list_value)
    return None if kind == "null_value" else getattr(value, kind)


def plain_struct(struct: Struct) -> dict[str, object]:
    """Return a Struct as a dict of plain Python values."""
    return {key: plain(value) for key, value in struct.fields.items()}


def plain_list(values: ListValue) -> list[object]:
    """Return a ListValue as a list of plain Python values."""
    return [plain(value) for value in values.values]
