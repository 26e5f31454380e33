"""Which fields are to have another number, and the one that each is offered: no two of a message the same."""

from __future__ import annotations

from collections.abc import Iterator

from generator.changes.cardinality import broken_by_cardinality, cardinalities, only_required
from generator.changes.numbers import next_field_number
from generator.changes.oneofs import broken_by_oneof
from generator.changes.pairing import FieldPair, MessagePair, fields_of_messages
from generator.changes.ranges import covers, missing
from generator.changes.renames import Rename, rename
from generator.changes.types import broken_by_type
from generator.protos import ProtoField
from generator.subject import Change, Subject


class NewNumbers:
    """The numbers that are offered to the fields of a change."""

    def __init__(self, subject: Subject, change: Change) -> None:
        self._subject = subject
        self._change = change
        self._of: dict[str, dict[int, int]] = {}

    def of(self, owner: str, number: int) -> int | None:
        """What is offered to the field of a message that has a number now; None where there is none left."""
        if owner not in self._of:
            self._of[owner] = self._handed_out(owner)
        return self._of[owner].get(number) or next_field_number(self._subject, owner, self._of[owner].values())

    def _handed_out(self, owner: str) -> dict[int, int]:
        offered: dict[int, int] = {}
        old, new = self._change.before.messages.get(owner), self._change.after.messages.get(owner)
        for field in _misplaced(MessagePair(self._change, old, new)) if old and new else ():
            number = next_field_number(self._subject, owner, offered.values())
            if number is not None:
                offered[field.number] = number
        return offered


def _misplaced(pair: MessagePair) -> Iterator[ProtoField]:
    """The fields whose numbers belong to something else."""
    freed = [part for was in pair.old.reserved for part in missing(was, pair.new.reserved)]
    pairs = {one.new.number: one for one in fields_of_messages(pair)}
    for field in sorted(pair.new.fields, key=lambda field: field.number):
        one = pairs.get(field.number)
        of_another = one is not None and (_is_another(one) or any(map(_is_another, _inside_of_map(one))))
        if of_another or covers(freed, field.number):
            yield field


def _is_another(pair: FieldPair) -> bool:
    cardinality = cardinalities(pair)
    return (
        broken_by_type(pair)
        or (broken_by_cardinality(*cardinality) and not only_required(*cardinality))
        or broken_by_oneof(pair)
        or rename(pair) in (Rename.MEANING, Rename.UNIT)
    )


def _inside_of_map(pair: FieldPair) -> Iterator[FieldPair]:
    """The key and the value of a map."""
    change = pair.change
    old, new = change.before.messages.get(pair.old.type_name), change.after.messages.get(pair.new.type_name)
    if old and new and new.map_entry and old.full_name == new.full_name:
        yield from fields_of_messages(MessagePair(change, old, new))
