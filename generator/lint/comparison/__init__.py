"""Comparison of two schemas: pairs each old message, enum and field with the new one, and finds incompatible changes.

Messages and enums are paired by full name, in any file. Fields and values are paired by number, and extensions by the
extended message and number, because encoded bytes contain numbers and no names.
"""

from roverlink.generator.lint.comparison.pairing import (
    EnumPair,
    FieldPair,
    MessagePair,
    enums,
    fields,
    fields_of_messages,
    gone_fields,
    gone_values,
    messages,
    values_by_number,
)
from roverlink.generator.lint.comparison.schema_change import SchemaChange, each_once

__all__ = [
    "EnumPair",
    "FieldPair",
    "MessagePair",
    "SchemaChange",
    "each_once",
    "enums",
    "fields",
    "fields_of_messages",
    "gone_fields",
    "gone_values",
    "messages",
    "values_by_number",
]
