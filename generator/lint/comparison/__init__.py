"""What became of a schema: its parts before and after, paired, and what a difference between them breaks.

Messages and enums are paired by their full names, wherever they stand; fields and values by their numbers; extensions
by the message that they extend and their number. That is how bytes find them.
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
