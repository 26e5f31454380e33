"""What a new name says about a field whose number stayed.

The name never travels as bytes; but whoever gives a number to something else mostly renames the field, and the bytes
of an old sender are then read as something that they are not.
"""

from __future__ import annotations

from enum import Enum

from generator.changes.breaks import Breaks
from generator.changes.field_type_changes import broken_by_type
from generator.changes.name_units import Measure, disagree, measure
from generator.changes.name_words import share_a_word, words
from generator.changes.pairing import FieldPair
from generator.protos import ProtoField

_WITHOUT_UNIT = frozenset({"string", "bytes", "bool", "enum"})


class Rename(Enum):
    """What became of a field's name."""

    NONE = "it is the same"
    WORDING = "another word for the same thing"
    UNIT = "the same thing in another unit, scale or reference"
    MEANING = "another thing"
    RETYPED = "another thing, as its type says already"


def rename(pair: FieldPair) -> Rename:
    """What the new name says."""
    if pair.old.name == pair.new.name:
        return Rename.WORDING if pair.moved else Rename.NONE
    if pair.in_map_entry:
        return Rename.WORDING
    if broken_by_type(pair) is Breaks.WIRE:
        return Rename.RETYPED
    if names_another_field(pair) or not share_a_word(_names(pair.old), _names(pair.new)):
        return Rename.MEANING
    measurable = pair.new.type not in _WITHOUT_UNIT and disagree(*measures(pair))
    return Rename.UNIT if measurable else Rename.WORDING


def renamed(pair: FieldPair) -> str:
    """That a field is called something else."""
    what = f"{pair.old.name} = {pair.old.number}"
    if pair.moved:
        return f"{what} of {pair.owner} is {pair.new.name} in another scope now, which is part of its name"
    return f"{what} is called {pair.new.name} now"


def measures(pair: FieldPair) -> tuple[Measure, Measure]:
    """What the names before and after say about how the value is to be read."""
    return measure(words(pair.old.name)), measure(words(pair.new.name))


def names_another_field(pair: FieldPair) -> bool:
    """Whether the new name was that of another number, as after fields were swapped."""
    fields = pair.messages.old.fields if pair.messages else ()
    return any(field.name == pair.new.name and field.number != pair.new.number for field in fields)


def json_name_changed(pair: FieldPair) -> bool:
    """Whether JSON calls it something else; extensions have their full name there."""
    if pair.extension:
        return pair.old.name != pair.new.name or pair.moved
    if not pair.change.of_ledger:
        return pair.old.json_name != pair.new.json_name
    # The ledger does not know JSON's names. Who chose one for the new name mostly kept the old one with it.
    chosen = pair.new.json_name != derived_json_name(pair.new.name)
    return not chosen and derived_json_name(pair.old.name) != derived_json_name(pair.new.name)


def old_json_name(pair: FieldPair) -> str:
    """What JSON called a field, if nothing else is called that now."""
    name = pair.old.json_name or derived_json_name(pair.old.name)
    fields = pair.messages.new.fields if pair.messages else ()
    return "" if any(name in (field.json_name, field.name) for field in fields if field != pair.new) else name


def derived_json_name(name: str) -> str:
    """JSON's name for a field that does not choose one (descriptor.proto, `json_name`)."""
    first, *rest = name.split("_")
    return first + "".join(part[:1].upper() + part[1:] for part in rest)


def _names(field: ProtoField) -> tuple[str, ...]:
    return (field.name, field.json_name) if field.json_name else (field.name,)
