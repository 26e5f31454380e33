"""What a new name says about a field whose number stayed.

The name never travels as bytes; but whoever gives a number to something else mostly renames the field, and the bytes
of an old sender are then read as something that they are not.
"""

from __future__ import annotations

from enum import Enum

from roverlink.generator.lint.comparison.field_type_changes import broken_by_type
from roverlink.generator.lint.comparison.pairing import FieldPair
from roverlink.generator.lint.names.name_units import Measure, disagree, measure
from roverlink.generator.lint.names.name_words import share_a_word, words
from roverlink.generator.protos.schema import ProtoField

_WITHOUT_UNIT = frozenset({"string", "bytes", "bool", "enum"})


class Rename(Enum):
    """What became of a field's name."""

    NONE = "the same thing, perhaps in other words"
    UNIT = "the same thing in another unit, scale or reference"
    MEANING = "another thing"
    RETYPED = "another thing, as its type says already"


def rename(pair: FieldPair) -> Rename:
    """What the new name says."""
    if pair.old.name == pair.new.name or pair.in_map_entry:
        return Rename.NONE
    if broken_by_type(pair):
        return Rename.RETYPED
    if names_another_field(pair) or not share_a_word(_names(pair.old), _names(pair.new)):
        return Rename.MEANING
    measurable = pair.new.type not in _WITHOUT_UNIT and disagree(*measures(pair))
    return Rename.UNIT if measurable else Rename.NONE


def measures(pair: FieldPair) -> tuple[Measure, Measure]:
    """What the names before and after say about how the value is to be read."""
    return measure(words(pair.old.name)), measure(words(pair.new.name))


def names_another_field(pair: FieldPair) -> bool:
    """Whether the new name was that of another number, as after fields were swapped."""
    fields = pair.messages.old.fields if pair.messages else ()
    return any(field.name == pair.new.name and field.number != pair.new.number for field in fields)


def _names(field: ProtoField) -> tuple[str, ...]:
    return (field.name, field.json_name) if field.json_name else (field.name,)
