"""Cardinality of a field: single, repeated or a map, and if absence is tracked. Some changes of it break decoding.

The rules come from protobuf's guide (protobuf.dev/programming-guides/proto3, "Updating A Message Type"). A change
between singular and repeated is not safe: a packed list of numbers is not a number, and only one of several values
survives. A map is a repeated message on the wire.
"""

from __future__ import annotations

from roverlink.generator.lint.comparison.pairing import FieldPair
from roverlink.generator.protos.schema import ProtoField, ProtoMessage, Schema

IMPLICIT, EXPLICIT, REQUIRED = "singular without presence", "singular with presence", "required"
REPEATED, MAP = "repeated", "a map"

# Presence changes what a sender leaves out (zero, or nothing), but not how a record is encoded. A map field is encoded
# as `repeated` entries of key 1 and value 2 (Language Guide, "Maps", backwards compatibility).
_ON_THE_WIRE = {IMPLICIT: EXPLICIT, MAP: REPEATED}


def cardinality(field: ProtoField, schema: Schema, extension: bool = False) -> str:
    """Return a field's cardinality: `MAP`, `REPEATED`, `REQUIRED`, `EXPLICIT` or `IMPLICIT`."""
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

    The ledger does not store this. A message from the ledger counts as an entry if its fields are `key` and `value`.
    """
    # A descriptor says it. A ledger has no file, and no such option.
    if message.file:
        return message.map_entry
    form = [(1, "key"), (2, "value")]
    return message.full_name.endswith("Entry") and sorted((one.number, one.name) for one in message.fields) == form


def broken_by_cardinality(old: str, new: str) -> bool:
    """Return True if a field with the new cardinality misreads bytes that were written with the old one."""
    return _ON_THE_WIRE.get(old, old) != _ON_THE_WIRE.get(new, new)


def only_required(old: str, new: str) -> bool:
    """Return True if both cardinalities allow at most one value, and at least one of them is `required`."""
    return REQUIRED in (old, new) and {old, new} <= {REQUIRED, IMPLICIT, EXPLICIT}


def shown(cardinality: str) -> str:
    """Return the name of a cardinality for messages. Implicit and explicit presence are both called singular."""
    return "singular" if cardinality in (IMPLICIT, EXPLICIT) else cardinality


def cardinalities(pair: FieldPair) -> tuple[str, str]:
    """Return the old and the new cardinality of a field that exists before and after a change."""
    if pair.in_map_entry:
        return EXPLICIT, EXPLICIT  # keys and values of a map are always single values
    old = cardinality(pair.old, pair.change.before, pair.extension)
    return old, cardinality(pair.new, pair.change.after, pair.extension)
