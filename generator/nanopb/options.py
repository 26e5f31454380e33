"""Readers of nanopb's options in their two forms: text in .options files, and bytes in protoc's descriptors."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from google.protobuf import text_format
from google.protobuf.message import DecodeError, Message
from google.protobuf.unknown_fields import UnknownFieldSet

from roverlink.generator.nanopb.vocabulary import EXTENSION, vocabulary
from roverlink.suggestions import nearest

Values = Mapping[str, Any]  # nanopb.proto declares the type of each option
"""The value of each option that is set, by nanopb's name: ``{"max_size": 20, "type": "FT_STATIC"}``."""

# protobuf's parser starts its messages with `line:column : 'the whole line': `. The diagnostic has its own place.
_POSITION = re.compile(r"\d+:\d+ : (?:'.*': )?(?=\w)", re.DOTALL)
_UNKNOWN = re.compile(r'Message type "[^"]+" has no field named "(?P<name>[^"]*)"')


class OptionsError(ValueError):
    """Raised for options that cannot be read."""

    def __init__(self, message: str, help: str = "", column: int = 0) -> None:
        super().__init__(message)
        self.help = help
        self.column = column
        """Column of the mistake in the text, counted from 1; 0 if it is unknown."""


def parse_options(text: str) -> Values:
    """Parse the options in a line of a .options file: ``max_size:20``. Raises `OptionsError` if they are wrong.

    ``text`` is the part of the line after the pattern.
    """
    options = vocabulary().options()
    try:
        text_format.Merge(text, options)
    except text_format.ParseError as error:
        raise _readable(error, options) from error
    values = _values(options)
    for name in _negative(values):
        raise OptionsError(f"the option {name!r} cannot be {values[name]}")
    return values


def _readable(error: text_format.ParseError, options: Message) -> OptionsError:
    text = _POSITION.sub("", str(error), count=1)
    column = error.GetColumn() or 0
    if match := _UNKNOWN.search(text):
        name = match["name"]
        return OptionsError(
            f"nanopb has no option {name!r}", nearest(name, options.DESCRIPTOR.fields_by_name, ""), column
        )
    return OptionsError(text, column=column)


@dataclass(frozen=True, slots=True)
class Decoded:
    """nanopb's options of a declaration in a .proto file, read from the declaration's serialized options."""

    values: Values
    deprecated: bool = False
    faults: tuple[str, ...] = ()
    """An error message for each option that cannot be read. These options are missing in ``values``."""


def decode_options(host: str, serialized: bytes) -> Decoded:
    """Decode the serialized options of a declaration; ``host`` is its kind, one of `vocabulary.HOSTS`."""
    words = vocabulary()
    try:
        carrier: Any = words.hosts[host].FromString(serialized)  # the class is made at run time
    except DecodeError:
        return Decoded({}, faults=("the options are not a protobuf message",))
    options = carrier.Extensions[words.extensions[host]]
    values = _values(options)
    negative = _negative(values)
    faults = (*_unknown(carrier, options), *(f"the option {name!r} cannot be {values[name]}" for name in negative))
    read = {name: value for name, value in values.items() if name not in negative}
    return Decoded(read, carrier.deprecated, faults)


def _unknown(carrier: Message, options: Message) -> Iterator[str]:
    """Yield an error message for each option, or value of an option, that the installed nanopb does not know."""
    if any(number == EXTENSION for number, _ in _unknown_fields(carrier)):
        yield "nanopb's options are not a message"
    for number, value in _unknown_fields(options):
        known = options.DESCRIPTOR.fields_by_number.get(number)
        yield (
            f"the option {known.name!r} cannot be {value!r}"
            if known
            else f"the installed nanopb has no option number {number}"
        )


def _unknown_fields(message: Message) -> Iterator[tuple[int, object]]:
    """Yield number and value of each unknown field of a message.

    A field is unknown if the message's type does not declare it, or declares it with another wire type.
    """
    fields = UnknownFieldSet(message)
    for index in range(len(fields)):
        yield fields[index].field_number, fields[index].data


def _negative(values: Values) -> list[str]:
    """Return the names of options with a negative value.

    This is always wrong, because nanopb's numbers are sizes or counts.
    """
    return [name for name, value in values.items() if isinstance(value, int) and value < 0]


def _values(options: Message) -> Values:
    return {
        field.name: field.enum_type.values_by_number[value].name if field.enum_type else value
        for field, value in options.ListFields()
    }
