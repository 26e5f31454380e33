"""What it breaks that a field has another type.

Of scalars, protobuf's own guide is the source (protobuf.dev/programming-guides/proto3, "Updating A Message Type"), and
its table of JSON values ("ProtoJSON Format"). Messages and enums of other names are looked into: where what the one
writes is what the other reads, only names have changed.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from generator.changes.breaks import Breaks
from generator.changes.cardinality import broken_by_cardinality, cardinality, is_map_entry
from generator.changes.change import Change
from generator.changes.pairing import FieldPair
from generator.protos import ProtoField, ProtoMessage

_VARINTS = frozenset({"int32", "int64", "uint32", "uint64", "bool"})
_ENUM_LIKE = frozenset({"enum", "int32", "int64", "uint32", "uint64"})
_SAME_BYTES = (
    _VARINTS,
    _ENUM_LIKE,
    frozenset({"sint32", "sint64"}),
    frozenset({"fixed32", "sfixed32"}),
    frozenset({"fixed64", "sfixed64"}),
)
_SAME_JSON = (
    frozenset({"int32", "uint32"}),
    frozenset({"int64", "uint64"}),
    frozenset({"fixed32", "sfixed32"}),
    frozenset({"fixed64", "sfixed64"}),
)
_WELL_KNOWN = "google.protobuf."


def kind(declared: ProtoField) -> str:
    """The scalar's name, ``message``, ``enum``; or ``group``, for all messages that are framed as groups are."""
    return "group" if declared.facets.get("delimited") else declared.type


def broken_by_kind(old: str, new: str) -> Breaks:
    """What it breaks to have one scalar in place of another, or an enum in place of an integer."""
    if old == new:
        return Breaks.NOTHING
    pair = {old, new}
    if any(pair <= group for group in _SAME_JSON):
        return Breaks.CODE
    # A string's bytes are bytes; not all bytes are a string's.
    if any(pair <= group for group in _SAME_BYTES) or (old, new) == ("string", "bytes"):
        return Breaks.JSON
    return Breaks.WIRE


def broken_by_type(pair: FieldPair) -> Breaks:
    """What it breaks that a field has the type that it has now."""
    return _Comparison(pair.change).types(pair.old, pair.new)


def retyped(change: Change, pairs: Iterator[FieldPair], breaks: Breaks) -> Iterator[FieldPair]:
    """The fields whose type changed in such a way that just this breaks."""
    comparison = _Comparison(change)
    yield from (pair for pair in pairs if comparison.types(pair.old, pair.new) is breaks)


@dataclass(slots=True)
class _Comparison:
    """Compares types, and those that are inside them."""

    change: Change
    assumed: set[tuple[str, str]] = field(default_factory=set)
    """Messages that are being compared: inside of each other, they count as alike."""

    def types(self, old: ProtoField, new: ProtoField) -> Breaks:
        old_kind, new_kind = kind(old), kind(new)
        if self.change.of_ledger and {old_kind, new_kind} == {"message", "group"}:
            old_kind = new_kind  # the ledger does not tell them apart
        if old_kind == new.type_name:
            return Breaks.NOTHING  # the ledger knows the name, and may have lost in a merge what it stands for
        if old_kind != new_kind:
            return broken_by_kind(old_kind, new_kind)
        if old.type_name == new.type_name:
            return Breaks.NOTHING
        if old_kind == "enum":
            return self._enums(old.type_name, new.type_name)
        return self._messages(old.type_name, new.type_name)

    def _enums(self, old: str, new: str) -> Breaks:
        """Every number has to stand for what it stood for."""
        before, after = self.change.before.enums.get(old), self.change.after.enums.get(new)
        if before is None or after is None:
            return Breaks.WIRE
        known = {(value.number, value.name) for value in after.values}
        return Breaks.CODE if {(value.number, value.name) for value in before.values} <= known else Breaks.WIRE

    def _messages(self, old: str, new: str) -> Breaks:
        before, after = self.change.before.messages.get(old), self.change.after.messages.get(new)
        if before is None or after is None:
            return Breaks.WIRE
        if (old, new) in self.assumed:
            return Breaks.NOTHING
        self.assumed.add((old, new))
        worst = max(self._contents(before, after), default=Breaks.NOTHING)
        self.assumed.discard((old, new))
        # Of a map's entry, nobody writes or knows the name; of the well-known types, JSON does.
        least = Breaks.NOTHING if is_map_entry(before) and is_map_entry(after) else Breaks.CODE
        if old.startswith(_WELL_KNOWN) or new.startswith(_WELL_KNOWN):
            least = Breaks.JSON
        return max(worst, least)

    def _contents(self, before: ProtoMessage, after: ProtoMessage) -> Iterator[Breaks]:
        """What each field breaks; all of them have to be there, and none may be needed that was not."""
        fields = {one.number: one for one in after.fields}
        for old in before.fields:
            new = fields.pop(old.number, None)
            if new is None:
                yield Breaks.WIRE
                continue
            yield self.types(old, new)
            yield broken_by_cardinality(*self._cardinalities(old, new))
            yield Breaks.NOTHING if old.name == new.name else Breaks.JSON
        yield from (Breaks.WIRE for new in fields.values() if new.label == "required")

    def _cardinalities(self, old: ProtoField, new: ProtoField) -> tuple[str, str]:
        return cardinality(old, self.change.before), cardinality(new, self.change.after)
