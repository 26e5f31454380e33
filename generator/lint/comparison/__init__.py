"""What became of a schema: its parts before and after, paired, and what a difference between them breaks.

Messages and enums are paired by their full names, wherever they stand; fields and values by their numbers; extensions
by the message that they extend and their number. That is how bytes find them.
"""

from roverlink.generator.lint.comparison.each_once import each_once, earlier
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
from roverlink.generator.lint.comparison.schema_change import Change

__all__ = [
    "Change",
    "EnumPair",
    "FieldPair",
    "MessagePair",
    "each_once",
    "earlier",
    "enums",
    "fields",
    "fields_of_messages",
    "gone_fields",
    "gone_values",
    "messages",
    "values_by_number",
]
