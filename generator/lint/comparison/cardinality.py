"""Cardinality: the number of values a field holds, and if bytes are misread when that changes.

After protobuf's guide (protobuf.dev/programming-guides/proto3, "Updating A Message Type"): singular and repeated are
not safe to exchange, since a packed list of numbers is no number, and of several values only one survives. A map is a
repeated message on the wire.
"""

from __future__ import annotations

from roverlink.generator.lint.comparison.pairing import FieldPair
from roverlink.generator.protos.schema import ProtoField, ProtoMessage, Schema

IMPLICIT, EXPLICIT, REQUIRED = "singular without presence", "singular with presence", "required"
REPEATED, MAP = "repeated", "a map"

_ON_THE_WIRE = {IMPLICIT: EXPLICIT, MAP: REPEATED}


def cardinality(field: ProtoField, schema: Schema, extension: bool = False) -> str:
    """One of the five."""
    if field.repeated:
        return MAP if is_map(field, schema) else REPEATED
    if field.label == "required":
        return REQUIRED
    always_explicit = extension or field.oneof or field.type in ("message", "group")
    return EXPLICIT if always_explicit or field.label == "optional" else IMPLICIT


def is_map(field: ProtoField, schema: Schema) -> bool:
    """Whether it was written as ``map<...>``."""
    entry = schema.messages.get(field.type_name)
    return field.repeated and entry is not None and is_map_entry(entry)


def is_map_entry(message: ProtoMessage) -> bool:
    """Whether a message is what a map repeats; of the ledger's, which have no file, its form has to say so."""
    if message.file:
        return message.map_entry
    form = [(1, "key"), (2, "value")]
    return message.full_name.endswith("Entry") and sorted((one.number, one.name) for one in message.fields) == form


def broken_by_cardinality(old: str, new: str) -> bool:
    """Tell whether bytes are misread with one cardinality in place of another."""
    return _ON_THE_WIRE.get(old, old) != _ON_THE_WIRE.get(new, new)


def only_required(old: str, new: str) -> bool:
    """Whether it holds one value on both sides, without which a message is refused on one of them."""
    return REQUIRED in (old, new) and {old, new} <= {REQUIRED, IMPLICIT, EXPLICIT}


def shown(cardinality: str) -> str:
    """A cardinality where it does not matter whether absence can be told from zero."""
    return "singular" if cardinality in (IMPLICIT, EXPLICIT) else cardinality


def cardinalities(pair: FieldPair) -> tuple[str, str]:
    """Those of a field before and after."""
    if pair.in_map_entry:
        return EXPLICIT, EXPLICIT  # a key and a value are what they are
    old = cardinality(pair.old, pair.change.before, pair.extension)
    return old, cardinality(pair.new, pair.change.after, pair.extension)
