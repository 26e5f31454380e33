"""Cardinality of a field: singular with or without presence, required, repeated, or a map.

Some changes of the cardinality break decoding. The rules come from protobuf's guide
(protobuf.dev/programming-guides/proto3, "Updating A Message Type"). A change between singular and repeated is not safe:
a receiver cannot read a packed list of numbers as one number, and it keeps only one of several values. A map is encoded
as a repeated message.
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.lint.comparison.pairing import FieldPair, MessagePair
from roverlink.generator.protos.schema import ProtoField, ProtoMessage, Schema

IMPLICIT, EXPLICIT, REQUIRED = "singular without presence", "singular with presence", "required"
REPEATED, MAP = "repeated", "a map"

# Presence changes what a sender leaves out (zero, or nothing), but not how a record is encoded. A map field is encoded
# as `repeated` entries of key 1 and value 2 (Language Guide, "Maps", backwards compatibility).
_ON_THE_WIRE = {IMPLICIT: EXPLICIT, MAP: REPEATED}


def cardinality(field: ProtoField, schema: Schema, extension: bool = False) -> str:
    """Return a field's cardinality: `MAP`, `REPEATED`, `REQUIRED`, `EXPLICIT` or `IMPLICIT` (without presence).

    ``extension`` is True for a protobuf extension.
    """
    if field.repeated:
        return MAP if is_map(field, schema) else REPEATED
    if field.label == "required":
        return REQUIRED
    # These have presence in every syntax (Application Note: Field Presence).
    always_explicit = extension or field.oneof or field.type in ("message", "group")
    return EXPLICIT if always_explicit or field.label == "optional" else IMPLICIT


def is_map(field: ProtoField, schema: Schema) -> bool:
    """Return True if the field is declared as ``map<...>``."""
    entry = schema.messages.get(field.type_name)
    return field.repeated and entry is not None and is_map_entry(entry)


def is_map_entry(message: ProtoMessage) -> bool:
    """Return True if a message is the entry that protoc generates for a map.

    The ledger does not store if a message is an entry. So a message from the ledger counts as an entry if its name ends
    with ``Entry`` and its fields are ``key = 1`` and ``value = 2``.
    """
    # A descriptor has the option `map_entry`. A message from the ledger has no file and no options.
    if message.file:
        return message.map_entry
    form = [(1, "key"), (2, "value")]
    return (
        message.full_name.endswith("Entry") and sorted((field.number, field.name) for field in message.fields) == form
    )


def broken_by_cardinality(old: str, new: str) -> bool:
    """Return True if a receiver with the new cardinality of a field misreads bytes that have the old cardinality."""
    return _ON_THE_WIRE.get(old, old) != _ON_THE_WIRE.get(new, new)


def only_required(old: str, new: str) -> bool:
    """Return True if both cardinalities allow at most one value, and at least one of them is `required`."""
    return REQUIRED in (old, new) and {old, new} <= {REQUIRED, IMPLICIT, EXPLICIT}


def required_changes(pair: MessagePair) -> Iterator[tuple[ProtoField | None, ProtoField | None]]:
    """Yield each field that is `required` only before or only after a change, as it was and as it is; None if absent.

    Fields that are repeated on the other side are left out: that change is graver.
    """
    before, after = ({field.number: field for field in message.fields} for message in (pair.old, pair.new))
    for number in sorted(before.keys() | after.keys()):
        both = before.get(number), after.get(number)
        labels = [field.label if field else "" for field in both]
        if labels.count("required") == 1 and "repeated" not in labels:
            yield both


def shown(cardinality: str) -> str:
    """Return the name of a cardinality for texts to the user: ``singular``, ``required``, ``repeated`` or ``a map``.

    A field with presence and a field without presence are both ``singular``.
    """
    return "singular" if cardinality in (IMPLICIT, EXPLICIT) else cardinality


def cardinalities(pair: FieldPair) -> tuple[str, str]:
    """Return the old and the new cardinality of a field that exists before and after a change."""
    if pair.in_map_entry:
        return EXPLICIT, EXPLICIT  # keys and values of a map are always single values
    old = cardinality(pair.old, pair.change.before, pair.extension)
    return old, cardinality(pair.new, pair.change.after, pair.extension)
