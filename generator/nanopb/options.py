"""nanopb's options as they are written: protobuf's text format in .options files, its wire format in .proto files."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from google.protobuf import text_format
from google.protobuf.message import DecodeError, Message
from google.protobuf.unknown_fields import UnknownFieldSet

from generator.diagnostics import nearest
from generator.nanopb.vocabulary import EXTENSION, NAMES, SIZES, Carrier, Options

Value = int | str
"""Of an option: a number, a text, the name of one of the values that it may have, or whether it is on."""

Values = Mapping[str, Value]
"""Options that are set, by name."""

_POSITION = re.compile(r"\d+:\d+ : (?:'.*': )?(?=\w)", re.DOTALL)
_UNKNOWN = re.compile(r'Message type "[^"]+" has no field named "(?P<name>[^"]*)"')


class OptionsError(ValueError):
    """Options that cannot be read."""

    def __init__(self, message: str, help: str = "", column: int = 0) -> None:
        super().__init__(message)
        self.help = help
        self.column = column
        """Where in the text, from 1; 0 where that is not known."""


def parse_options(text: str) -> Values:
    """The options in a line of a .options file, behind its pattern."""
    options = Options()
    try:
        text_format.Merge(text, options)
    except text_format.ParseError as error:
        raise _readable(error) from error
    values = _values(options)
    for fault in _negative(values):
        raise OptionsError(fault)
    return values


def _readable(error: text_format.ParseError) -> OptionsError:
    said = _POSITION.sub("", str(error), count=1)
    column = error.GetColumn() or 0
    if match := _UNKNOWN.search(said):
        name = match["name"]
        return OptionsError(f"nanopb has no option {name!r}", nearest(name, NAMES.values()), column)
    return OptionsError(said, column=column)


@dataclass(frozen=True, slots=True)
class Decoded:
    """What is of interest in the serialized options of something in a .proto file."""

    values: Values
    deprecated: bool
    faults: tuple[str, ...]
    """What of nanopb's options cannot be read; ``values`` are the others."""


def decode_options(serialized: bytes) -> Decoded:
    """Read nanopb's options in the serialized options of a file, message, enum or field."""
    try:
        carrier: Any = Carrier.FromString(serialized)  # a class that is made at run time
    except DecodeError:
        return Decoded({}, False, ("the options are no protobuf message",))
    values = _values(carrier.options)
    faults = tuple(_unknown(carrier)) + tuple(_negative(values))
    read = {name: value for name, value in values.items() if not (name in SIZES and _is_negative(value))}
    return Decoded(read, carrier.deprecated, faults)


def _unknown(carrier: Any) -> Iterator[str]:
    """Options, and values of options, that are newer than this vocabulary, or broken."""
    if any(number == EXTENSION for number, _ in _unknown_fields(carrier)):
        yield "nanopb's options are no message"
    for number, value in _unknown_fields(carrier.options):
        name = NAMES.get(number)
        yield f"{name} cannot be {value!r}" if name else f"nanopb's option number {number} is not known"


def _unknown_fields(message: Message) -> Iterator[tuple[int, object]]:
    """Numbers and values of what a message does not declare, or not so."""
    fields = UnknownFieldSet(message)
    for index in range(len(fields)):
        yield fields[index].field_number, fields[index].data


def _negative(values: Values) -> Iterator[str]:
    for name, value in values.items():
        if name in SIZES and _is_negative(value):
            yield f"{name} cannot be {value}"


def _is_negative(value: Value) -> bool:
    return isinstance(value, int) and value < 0


def _values(options: Message) -> dict[str, Value]:
    values: dict[str, Value] = {}
    for field, value in options.ListFields():
        if field.enum_type:
            values[field.name] = field.enum_type.values_by_number[value].name
        elif isinstance(value, (int, str)):
            values[field.name] = value
        else:
            values[field.name] = " ".join(value)  # of the lists of files to include, and not to
    return values
