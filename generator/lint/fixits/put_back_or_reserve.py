"""Help texts that tell the user to put back an old declaration, or to reserve its number."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from roverlink.generator.lint.comparison.cardinality import is_map
from roverlink.generator.lint.comparison.field_type_changes import kind
from roverlink.generator.lint.comparison.pairing import EnumPair, FieldPair, MessagePair, written
from roverlink.generator.lint.comparison.schema_change import SchemaChange
from roverlink.generator.lint.fixits.declarations import declaration
from roverlink.generator.protos.number_ranges import Range, covers, missing, spelled
from roverlink.generator.protos.schema import ProtoEnum, ProtoField, ProtoMessage, Syntax


def was(pair: FieldPair) -> str:
    """Return the declaration that a field had before the change, such as ``float speed = 3;``."""
    owner, old, _ = written(pair)
    return declaration(old, pair.change.before, owner, pair.old_syntax)


def back(pair: FieldPair) -> str:
    """Return a help text that tells how to undo the change of a field."""
    owner, old, _ = written(pair)
    declared = declaration(old, pair.change.before, owner, pair.syntax)
    return f"put back `{declared}`{_with_type(pair.change, old, kind(pair.new) == 'group')}"


def _with_type(change: SchemaChange, old: ProtoField, declares_type: bool = False) -> str:
    """Return the end of a help text that says what else the user must change to give a field its old type again.

    A map and a group declare their message type themselves, so the user must remove a message of the same name. If the
    old type was deleted, the user must put it back. The text is empty if nothing else must change.
    """
    now = change.after.messages.get(old.type_name)
    if old.type == "group" or is_map(old, change.before):
        in_the_way = now is not None and not now.map_entry and not declares_type
        return f" in place of message {old.type_name.rpartition('.')[2]}" if in_the_way else ""
    gone = old.type_name and now is None and old.type_name not in change.after.enums and not change.of_ledger
    return " with its type" if gone else ""


def reserve(new: ProtoMessage | ProtoEnum, syntax: Syntax, numbers: Iterable[Range], names: Iterable[str]) -> str:
    """Return the statements that reserve numbers and names in a message or enum: ``reserved 3; reserved "speed";``.

    Numbers and names that are already reserved are left out, and so are names that are in use.
    """
    left = [part for number in numbers for part in missing(number, new.reserved)]
    free = [name for name in names if name not in new.reserved_names and name not in names_in_use(new)]
    of_numbers = f"reserved {spelled(left)};" if left else ""
    return " ".join(filter(None, (of_numbers, reserve_names(free, syntax) if free else "")))


def reserve_names(names: Iterable[str], syntax: Syntax) -> str:
    """Return the statement that reserves names: ``reserved "speed";``, or ``reserved speed;`` in an edition."""
    quote = "" if syntax.is_edition else '"'
    return f"reserved {', '.join(f'{quote}{name}{quote}' for name in names)};"


def names_in_use(new: ProtoMessage | ProtoEnum) -> dict[str, int]:
    """Return the names of a message's fields or of an enum's values, each with its number."""
    return {part.name: part.number for part in (new.fields if isinstance(new, ProtoMessage) else new.values)}


def put_back_or_reserve(pair: MessagePair, field: ProtoField) -> str:
    """Return the help text for a deleted field: put it back, or reserve its number and name."""
    put = put_back(pair, field)
    # A parser rejects a message that lacks a required field, so reserving the number would not help old receivers.
    if field.label == "required":
        return put
    return _or_reserve(pair, put, field.number, [field.name])


def put_back(pair: MessagePair, field: ProtoField) -> str:
    """Return a help text that tells how to put back a deleted field."""
    declared = declaration(field, pair.change.before, pair.old.full_name, pair.syntax)
    return f"put back `{declared}`{_with_type(pair.change, field)}{_in_place_of(pair.new, field.number, [field.name])}"


def value_back_or_reserve(pair: EnumPair, number: int, names: Sequence[str]) -> str:
    """Return the help text for a deleted enum value: put it back, or reserve its number and names."""
    return _or_reserve(pair, put_values_back(pair, number, names), number, names)


def put_values_back(pair: EnumPair, number: int, names: Sequence[str]) -> str:
    """Return a help text that tells how to put back deleted enum values.

    If values share a number, the text includes the option ``allow_alias``.
    """
    numbers = [value.number for value in pair.new.values]
    shared, allowed = len(names) + numbers.count(number) > 1, len(set(numbers)) < len(numbers)
    option = "option allow_alias = true; " if shared and not allowed else ""
    return f"put back `{option}{values(names, number)}`{_in_place_of(pair.new, number, names)}"


def values(names: Iterable[str], number: int) -> str:
    """Return the declarations of enum values that share a number: ``IDLE = 0; STOPPED = 0;``."""
    return " ".join(f"{name} = {number};" for name in names)


def _or_reserve(pair: MessagePair | EnumPair, put: str, number: int, names: Sequence[str]) -> str:
    statements = reserve(pair.new, pair.syntax, [(number, number)], names)
    if covers(pair.new.reserved, number) or not set(names).isdisjoint(pair.new.reserved_names):
        return f"write `{statements}` as well, or {put}"
    return f"{put}, or write `{statements}`"


def _in_place_of(new: ProtoMessage | ProtoEnum, number: int, names: Iterable[str]) -> str:
    """Return the end of a help text that names what the user must remove to put back a deleted declaration.

    This is a declaration that now has one of the names, or a reservation of the number or a name.
    """
    used = names_in_use(new)
    moved = [f"{name} = {used[name]}" for name in names if name in used]
    held = [str(number)] * covers(new.reserved, number) + [f'"{name}"' for name in names if name in new.reserved_names]
    found = moved + [f"`reserved` of {' and '.join(held)}"] * bool(held)
    return f" in place of {', and '.join(found)}" if found else ""
