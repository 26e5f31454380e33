"""The values of google.protobuf.Value as JSON, and back; every double keeps its bits, but NaN and infinity are none."""

from __future__ import annotations

import json
import math
import reprlib
from collections.abc import Callable
from typing import Any, TypeVar

from google.protobuf.struct_pb2 import ListValue, NullValue, Struct, Value

from runtime.errors import ConversionError

B = TypeVar("B", Struct, Value, ListValue)


def text_of(read: Callable[[Any], object], payload: Struct | Value | ListValue, field: str) -> str:
    """The JSON of a payload, keys in order. Raises `ConversionError` where it says something that JSON cannot."""
    try:
        return json.dumps(read(payload), ensure_ascii=False, sort_keys=True, allow_nan=False)
    except ValueError as error:
        raise ConversionError(f"cannot be JSON: {error}", field) from error


def parsed(text: str, field: str) -> Any:
    """What a text of JSON says. Raises `ConversionError` where it is none, or says what a Value cannot."""
    try:
        return json.loads(
            text, parse_int=_number, parse_float=_number, parse_constant=_number, object_pairs_hook=_without_repetition
        )
    except ValueError as error:
        raise ConversionError(f"is no JSON that protobuf can hold: {error}", field) from error
    except RecursionError as error:
        raise ConversionError("is JSON that is nested too deeply", field) from error


def built(build: Callable[[Any], B], said: object, field: str) -> B:
    """The payload of what `parsed` gave. Raises `ConversionError` for a text with half a character in it."""
    try:
        return build(said)
    except (UnicodeEncodeError, RecursionError) as error:
        raise ConversionError(f"is no JSON that protobuf can hold: {error}", field) from error


def _number(text: str) -> float:
    number = float(text)
    if not math.isfinite(number):
        raise ValueError(f"{reprlib.repr(text)} is too large for a double, or no number")
    if text.lstrip("-").isdigit() and number != int(text):
        raise ValueError(f"{text} is no double; the nearest one is {number!r}")
    return number


def _without_repetition(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    made = dict(pairs)
    if len(made) < len(pairs):
        raise ValueError("a key stands twice in one object")
    for key in made:
        key.encode()  # half a character, as in "\\ud800", is none that protobuf takes
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


def value_of(said: Any) -> Value:
    """The Value of what `parsed` gives."""
    if said is None:
        return Value(null_value=NullValue.NULL_VALUE)
    if isinstance(said, bool):
        return Value(bool_value=said)
    if isinstance(said, str):
        return Value(string_value=said)
    if isinstance(said, float):
        return Value(number_value=said)
    return Value(struct_value=struct_of(said)) if isinstance(said, dict) else Value(list_value=list_of(said))


def struct_of(said: dict[str, Any]) -> Struct:
    """The Struct of what `parsed` gives."""
    return Struct(fields={key: value_of(value) for key, value in said.items()})


def list_of(said: list[Any]) -> ListValue:
    """The ListValue of what `parsed` gives."""
    return ListValue(values=[value_of(value) for value in said])
