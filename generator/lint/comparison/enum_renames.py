"""Renames of enum values: a number has another name than before."""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.lint.comparison.pairing import EnumPair, enums, values_by_number
from roverlink.generator.lint.comparison.schema_change import SchemaChange
from roverlink.generator.protos.schema import ProtoEnumValue


def renamed_values(change: SchemaChange) -> Iterator[tuple[EnumPair, int, tuple[str, ...], list[ProtoEnumValue]]]:
    """Yield each enum number whose old name is gone, although the number is still in use.

    Each item has the enum before and after the change, the number, the names that the number lost, and the values that
    have the number now.
    """
    for pair in enums(change):
        for number, gone, values in renamed_in(pair):
            yield pair, number, gone, values


def renamed_in(pair: EnumPair) -> Iterator[tuple[int, tuple[str, ...], list[ProtoEnumValue]]]:
    """Yield the same for one enum, without the enum."""
    after = values_by_number(pair.new)
    for number, before in values_by_number(pair.old).items():
        left = {value.name for value in after.get(number, [])}
        gone = tuple(value.name for value in before if value.name not in left)
        if gone and left:
            yield number, gone, after[number]


def moved_here(pair: EnumPair, number: int) -> ProtoEnumValue | None:
    """Return the old enum value whose name ``number`` has now; None if no other number had this name.

    If FOO was 1 and is now 2, the result for 2 is the old FOO.
    """
    names = {value.name for value in pair.new.values if value.number == number}
    return next((value for value in pair.old.values if value.name in names and value.number != number), None)


def moved_away(pair: EnumPair, number: int) -> ProtoEnumValue | None:
    """Return the enum value that now has a former name of ``number``; None if there is none.

    If FOO was 1 and is now 2, the result for 1 is FOO. If a number kept one of its former names, the result is None.
    """
    names = {value.name for value in pair.old.values if value.number == number}
    if any(value.name in names and value.number == number for value in pair.new.values):
        return None
    return next((value for value in pair.new.values if value.name in names), None)
