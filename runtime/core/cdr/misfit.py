"""Search for the field whose value does not fit its type, so that an error can name the field."""

from __future__ import annotations

import reprlib
import struct
from typing import Any

from roverlink.runtime.core.cdr.variable import part_of
from roverlink.runtime.core.errors import ConversionError
from roverlink.runtime.core.messages import Array, FieldType, Message, Primitive, Sequence, Text, fields_of

# struct raises struct.error for an integer out of range, OverflowError for a float; the others come from values of a
# wrong type, such as None.
UNWRITABLE = (struct.error, OverflowError, TypeError, ValueError, AttributeError)
"""Exceptions that writing a value may raise if it does not fit its type."""


def misfit(message: Message, prefix: str = "") -> ConversionError | None:
    """Return the error of the first field whose value does not fit its type; None if all values fit.

    ``prefix`` is the path of the message inside another message, with a dot at its end.
    """
    for field in fields_of(type(message)):
        found = _value_misfit(field.type, getattr(message, field.name), prefix + field.name)
        if found is not None:
            return found
    return None


def _value_misfit(field_type: FieldType, value: Any, path: str) -> ConversionError | None:
    if isinstance(field_type, type) and isinstance(value, field_type):
        return misfit(value, f"{path}.")
    if isinstance(field_type, (Sequence, Array)) and isinstance(value, list):
        for index, element in enumerate(value):
            found = _value_misfit(field_type.element, element, f"{path}[{index}]")
            if found is not None:
                return found
    # `struct` reports only that some value of the whole format failed. Writing them one by one finds the field.
    try:
        part_of(field_type, "<").write(bytearray(), value)
    except UNWRITABLE as error:
        return ConversionError(f"{reprlib.repr(value)} does not fit {type_name(field_type)} ({error})", path)
    return None


def type_name(field_type: FieldType) -> str:
    """Return a field's type as it is written in a .msg file: ``float32``, ``uint8[<=4]``, ``comms/msg/BoundingBox``."""
    if isinstance(field_type, Primitive):
        return field_type.name
    if isinstance(field_type, Text):
        return "string" if field_type.bound is None else f"string<={field_type.bound}"
    if isinstance(field_type, Sequence):
        bound = "" if field_type.bound is None else f"<={field_type.bound}"
        return f"{type_name(field_type.element)}[{bound}]"
    if isinstance(field_type, Array):
        return f"{type_name(field_type.element)}[{field_type.length}]"
    return field_type.__msgtype__
