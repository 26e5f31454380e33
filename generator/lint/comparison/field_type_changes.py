"""Compatibility of a field's old and new type: decides if a receiver with the new type misreads old bytes.

For scalars, the rules come from protobuf's guide (protobuf.dev/programming-guides/proto3, "Updating A Message Type").
Messages and enums with different names are compared by content: if the new type reads the old bytes correctly, only the
name has changed.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from roverlink.generator.lint.comparison.cardinality import broken_by_cardinality, cardinality
from roverlink.generator.lint.comparison.pairing import FieldPair
from roverlink.generator.lint.comparison.schema_change import SchemaChange
from roverlink.generator.protos.schema import ProtoField, ProtoMessage

# The groups of the guide. Within a group, a value that fits both types is read as sent; a larger one is cut off, as by
# a cast in C++. sint32 and sint64 are varints too, but ZigZag encoded: -1 is sent as 1 (encoding guide, "Signed
# Integers"). An enum goes with integers and not with bool. float and double stand alone.
#
# The guide also calls a message compatible with bytes that contain its encoding. It is reported here: the other side
# gets bytes that its code does not decode.
_VARINTS = frozenset({"int32", "int64", "uint32", "uint64", "bool"})
ENUM_LIKE = frozenset({"enum", "int32", "int64", "uint32", "uint64"})
_SAME_BYTES = (
    _VARINTS,
    ENUM_LIKE,
    frozenset({"sint32", "sint64"}),
    frozenset({"fixed32", "sfixed32"}),
    frozenset({"fixed64", "sfixed64"}),
)


def kind(declared: ProtoField) -> str:
    """Return the name of a field's scalar type, or ``message``, ``enum`` or ``group``.

    A message that is encoded as a group counts as ``group``; in an edition, this is the feature ``DELIMITED``.
    """
    return "group" if declared.facets.get("delimited") else declared.type


def broken_by_kind(old: str, new: str) -> bool:
    """Return True if a receiver with the field type ``new`` misreads bytes of the field type ``old``.

    Both are results of `kind`, such as ``int32`` or ``message``.
    """
    # A reader of bytes accepts any string. A reader of a string rejects bytes that are not UTF-8.
    return old != new and (old, new) != ("string", "bytes") and not any({old, new} <= group for group in _SAME_BYTES)


def broken_by_type(pair: FieldPair) -> bool:
    """Return True if a receiver with the new type of a field misreads bytes of the old type."""
    return _Comparison(pair.change).types(pair.old, pair.new)


@dataclass(slots=True)
class _Comparison:
    """Comparison of an old and a new type, with the types inside them.

    Its methods return True if a receiver with the new type misreads bytes of the old type.
    """

    change: SchemaChange
    assumed: set[tuple[str, str]] = field(default_factory=set)
    """Old and new name of each pair of messages whose comparison has started and is not finished.

    A message may contain a field of its own type. Then this field counts as compatible, which ends the recursion.
    """

    def types(self, old: ProtoField, new: ProtoField) -> bool:
        old_kind, new_kind = kind(old), kind(new)
        if self.change.of_ledger and {old_kind, new_kind} == {"message", "group"}:
            old_kind = new_kind  # the ledger does not distinguish them
        if old_kind == new.type_name:
            return False  # the ledger has the type's name, but a merge may have lost its fields
        if old_kind != new_kind:
            return broken_by_kind(old_kind, new_kind)
        if old.type_name == new.type_name:
            return False
        if old_kind == "enum":
            return self._enums(old.type_name, new.type_name)
        return self._messages(old.type_name, new.type_name)

    def _enums(self, old: str, new: str) -> bool:
        """Return True if an old number of the enum is missing in the new enum, or has another name there."""
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
        """Compare the fields of two messages; yield for each check True if it failed, and False if it passed.

        There is one check for each old field: it fails if the new message lacks the field's number, or has another type
        there that reads the bytes differently. The last check fails if a new field is required.
        """
        fields = {field.number: field for field in after.fields}
        for old in before.fields:
            new = fields.pop(old.number, None)
            # Unlike in the field's own message, a deleted field counts as broken here: it shows that the two types are
            # different ones, and not one type under a new name.
            yield new is None or self.types(old, new) or broken_by_cardinality(*self._cardinalities(old, new))
        yield any(new.label == "required" for new in fields.values())

    def _cardinalities(self, old: ProtoField, new: ProtoField) -> tuple[str, str]:
        return cardinality(old, self.change.before), cardinality(new, self.change.after)
