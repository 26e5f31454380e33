"""The values of google.protobuf.Value as JSON, and back; every double keeps its bits; NaN and infinity are refused."""

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
    """The JSON of a payload, keys in order. Raises `ConversionError` where it says something that JSON cannot."""
    try:
        return json.dumps(read(payload), ensure_ascii=False, sort_keys=True, allow_nan=False)
    except ValueError as error:
        raise ConversionError(f"cannot be JSON: {error}", field) from error


def value_of(text: str, field: str) -> Value:
    """Parse JSON. Raises `ConversionError` if the text is not JSON, or if a Value cannot hold what it says."""
    try:
        said = json.loads(
            text, parse_int=_integer, parse_float=_finite, parse_constant=_finite, object_pairs_hook=_without_repetition
        )
        return ParseDict(said, Value())
    except (ValueError, ParseError) as error:
        raise ConversionError(f"is no JSON that protobuf can hold: {error}", field) from error
    except RecursionError as error:
        raise ConversionError("is JSON that is nested too deeply", field) from error


def _finite(text: str) -> float:
    number = float(text)
    if not math.isfinite(number):
        raise ValueError(f"{reprlib.repr(text)} is too large for a double, or no number")
    return number


def _integer(text: str) -> float:
    number = _finite(text)
    if number != int(text):
        raise ValueError(f"{text} is no double; the nearest one is {number!r}")
    return number + 0.0  # protobuf reads -0 as an integer, which has no sign


def _without_repetition(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    made = dict(pairs)
    if len(made) < len(pairs):
        raise ValueError("a key stands twice in one object")
    return made


def plain(value: Value) -> object:
    """What a Value says, as Python has it. Raises `ValueError` where it says nothing."""
    kind = value.WhichOneof("kind")
    if kind is None:
        raise ValueError("a google.protobuf.Value has no kind")
    if kind == "struct_value":
        return plain_struct(value.struct_value)
    if kind == "list_value":
        return plain_list(value.list_value)
    return None if kind == "null_value" else getattr(value, kind)


def plain_struct(struct: Struct) -> dict[str, object]:
    """What a Struct says, as Python has it."""
    return {key: plain(value) for key, value in struct.fields.items()}


def plain_list(values: ListValue) -> list[object]:
    """What a ListValue says, as Python has it."""
    return [plain(value) for value in values.values]
