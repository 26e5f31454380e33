"""Compatibility of a field's old and new type: tells if bytes are misread.

Of scalars, protobuf's own guide is the source (protobuf.dev/programming-guides/proto3, "Updating A Message Type").
Messages and enums of other names are looked into: where what the one
writes is what the other reads, only names have changed.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from roverlink.generator.lint.comparison.cardinality import broken_by_cardinality, cardinality
from roverlink.generator.lint.comparison.pairing import FieldPair
from roverlink.generator.lint.comparison.schema_change import SchemaChange
from roverlink.generator.protos.schema import ProtoField, ProtoMessage

_VARINTS = frozenset({"int32", "int64", "uint32", "uint64", "bool"})
_ENUM_LIKE = frozenset({"enum", "int32", "int64", "uint32", "uint64"})
_SAME_BYTES = (
    _VARINTS,
    _ENUM_LIKE,
    frozenset({"sint32", "sint64"}),
    frozenset({"fixed32", "sfixed32"}),
    frozenset({"fixed64", "sfixed64"}),
)


def kind(declared: ProtoField) -> str:
    """The scalar's name, ``message``, ``enum``; or ``group``, for all messages that are framed as groups are."""
    return "group" if declared.facets.get("delimited") else declared.type


def broken_by_kind(old: str, new: str) -> bool:
    """Tell whether bytes are misread with one scalar in place of another, or an enum in place of an integer."""
    # A string's bytes are bytes; not all bytes are a string's.
    return old != new and (old, new) != ("string", "bytes") and not any({old, new} <= group for group in _SAME_BYTES)


def broken_by_type(pair: FieldPair) -> bool:
    """Tell whether bytes are misread because a field has the type that it has now."""
    return _Comparison(pair.change).types(pair.old, pair.new)


@dataclass(slots=True)
class _Comparison:
    """Compares types, and those that are inside them; each result tells whether bytes are misread."""

    change: SchemaChange
    assumed: set[tuple[str, str]] = field(default_factory=set)
    """Messages that are being compared: inside of each other, they count as alike."""

    def types(self, old: ProtoField, new: ProtoField) -> bool:
        old_kind, new_kind = kind(old), kind(new)
        if self.change.of_ledger and {old_kind, new_kind} == {"message", "group"}:
            old_kind = new_kind  # the ledger does not tell them apart
        if old_kind == new.type_name:
            return False  # the ledger knows the name, and may have lost in a merge what it stands for
        if old_kind != new_kind:
            return broken_by_kind(old_kind, new_kind)
        if old.type_name == new.type_name:
            return False
        if old_kind == "enum":
            return self._enums(old.type_name, new.type_name)
        return self._messages(old.type_name, new.type_name)

    def _enums(self, old: str, new: str) -> bool:
        """Every number has to stand for what it stood for."""
        before, after = self.change.before.enums.get(old), self.change.after.enums.get(new)
        if before is None or after is None:
            return True
        known = {(value.number, value.name) for value in after.values}
        return not {(value.number, value.name) for value in before.values} <= known

    def _messages(self, old: str, new: str) -> bool:
        before, after = self.change.before.messages.get(old), self.change.after.messages.get(new)
        if before is None or after is None:
            return True
        if (old, new) in self.assumed:
            return False
        self.assumed.add((old, new))
        broken = any(self._contents(before, after))
        self.assumed.discard((old, new))
        return broken

    def _contents(self, before: ProtoMessage, after: ProtoMessage) -> Iterator[bool]:
        """Judge each field; all of them have to be there, and none may be needed that was not."""
        fields = {one.number: one for one in after.fields}
        for old in before.fields:
            new = fields.pop(old.number, None)
            yield new is None or self.types(old, new) or broken_by_cardinality(*self._cardinalities(old, new))
        yield any(new.label == "required" for new in fields.values())

    def _cardinalities(self, old: ProtoField, new: ProtoField) -> tuple[str, str]:
        return cardinality(old, self.change.before), cardinality(new, self.change.after)
