"""Default values: the value that a receiver reads for an absent field.

Without a declared default it is zero, empty or false; for an enum it is the first value. The default is never sent:
each side uses the one that it was compiled with.
"""

from __future__ import annotations

import math
import struct

from google.protobuf.text_encoding import CEscape, CUnescape

from roverlink.generator.lint.comparison.pairing import FieldPair
from roverlink.generator.protos.schema import ProtoField, Schema

Value = float | int | str | bytes


def default(field: ProtoField, schema: Schema) -> Value:
    """Return the value that a receiver reads if a field is absent: the number for an enum, 0 or 1 for a bool.

    The field must not be repeated or a message.
    """
    text = field.facets.get("default", "")
    if field.type == "enum":
        return _number(field, text, schema)
    if field.type == "string":
        return text
    if field.type == "bytes":
        # In a descriptor, the default of a bytes field is C-escaped; all other defaults are plain text
        # (descriptor.proto, `default_value`).
        return CUnescape(text)
    if field.type in ("double", "float"):
        value = float(text or 0)
        return _as_float32(value) if field.type == "float" else value
    return {"true": 1, "false": 0}[text] if field.type == "bool" and text else int(text or 0)


def shown(field: ProtoField, schema: Schema) -> str:
    """Return the value that a receiver reads if a field is absent, as text of a .proto file: ``false``, ``1.5``."""
    text = field.facets.get("default", "")
    if field.type == "enum" and not text:
        enum = schema.enums.get(field.type_name)
        return enum.values[0].name if enum and enum.values else "0"
    if field.type == "string":
        return f'"{CEscape(text.encode(), as_utf8=True)}"'
    if field.type == "bytes":
        return f'"{text}"'
    return text or ("false" if field.type == "bool" else "0")


def default_changed(pair: FieldPair) -> bool:
    """Return True if a receiver now reads another value than before when the field is absent."""
    if pair.change.of_ledger or not (_may_have_default(pair.old) and _may_have_default(pair.new)):
        return False
    old, new = default(pair.old, pair.change.before), default(pair.new, pair.change.after)
    # 0, 0.0, "", b"" and false are all the value of an absent field without default; a type change between them is not
    # a change of the default.
    if not old and not new:
        return False
    if isinstance(old, (str, bytes)) or isinstance(new, (str, bytes)):
        return _encoded(old) is None or _encoded(old) != _encoded(new)
    # 0.1 as float and as double differ, although the file has the same text. A receiver with float reads the rounded
    # value.
    if "float" in (pair.old.type, pair.new.type) and {pair.old.type, pair.new.type} <= {"float", "double"}:
        old, new = _as_float32(old), _as_float32(new)
    # NaN is not equal to itself.
    return old != new and not (math.isnan(old) and math.isnan(new))


def _may_have_default(field: ProtoField) -> bool:
    return not field.repeated and field.type not in ("message", "group")


def _number(field: ProtoField, name: str, schema: Schema) -> int:
    enum = schema.enums.get(field.type_name)
    values = enum.values if enum else ()
    return next((value.number for value in values if not name or value.name == name), 0)


def _encoded(value: Value) -> bytes | None:
    """Return a string value as UTF-8 bytes, and a bytes value unchanged; None for a number."""
    return value.encode() if isinstance(value, str) else value if isinstance(value, bytes) else None


def _as_float32(value: float) -> float:
    """Return the 32-bit floating point number that is nearest to a value; infinity if the value is too large."""
    try:
        # Python has no 32-bit float; packing rounds to the nearest one, as a C++ receiver does.
        return float(struct.unpack("<f", struct.pack("<f", value))[0])
    except OverflowError:
        return math.copysign(math.inf, value)
