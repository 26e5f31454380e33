"""Compatibility of a field's old and new type: decides if the new type misreads bytes of the old type.

For scalars, the rules come from protobuf's guide (protobuf.dev/programming-guides/proto3, "Updating A Message Type").
Messages and enums with different names are compared by content: if each side reads the other's bytes correctly, only
the name has changed.
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
_ENUM_LIKE = frozenset({"enum", "int32", "int64", "uint32", "uint64"})
_SAME_BYTES = (
    _VARINTS,
    _ENUM_LIKE,
    frozenset({"sint32", "sint64"}),
    frozenset({"fixed32", "sfixed32"}),
    frozenset({"fixed64", "sfixed64"}),
)


def kind(declared: ProtoField) -> str:
    """Return the name of a field's scalar type, or ``message``, ``enum`` or ``group``.

    A message that is encoded as a group counts as ``group``, also in an edition.
    """
    return "group" if declared.facets.get("delimited") else declared.type


def broken_by_kind(old: str, new: str) -> bool:
    """Return True if bytes of the old kind of type are misread with the new kind; see `kind`."""
    # A reader of bytes accepts any string. A reader of a string rejects bytes that are not UTF-8.
    return old != new and (old, new) != ("string", "bytes") and not any({old, new} <= group for group in _SAME_BYTES)


def broken_by_type(pair: FieldPair) -> bool:
    """Return True if the new type of a field misreads bytes of the old type."""
    return _Comparison(pair.change).types(pair.old, pair.new)


@dataclass(slots=True)
class _Comparison:
    """Comparison of an old and a new type, with the types inside them.

    A result of True means that bytes are misread.
    """

    change: SchemaChange
    assumed: set[tuple[str, str]] = field(default_factory=set)
    """Names of the message pairs that are being compared.

    Such a pair counts as equal inside itself, to end the recursion.
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
        """Return True if an old number of the enum is missing now, or has another name."""
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
        """Compare the fields of two messages; one of the results is True if bytes are misread.

        Each old field must still exist with a compatible type, and no new field may be required.
        """
        fields = {one.number: one for one in after.fields}
        for old in before.fields:
            new = fields.pop(old.number, None)
            # Unlike in the field's own message, a deleted field counts as broken here: it shows that the two types are
            # different ones, and not one type under a new name.
            yield new is None or self.types(old, new) or broken_by_cardinality(*self._cardinalities(old, new))
        yield any(new.label == "required" for new in fields.values())

    def _cardinalities(self, old: ProtoField, new: ProtoField) -> tuple[str, str]:
        return cardinality(old, self.change.before), cardinality(new, self.change.after)
