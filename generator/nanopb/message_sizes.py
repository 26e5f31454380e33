"""Largest encoded size of a message in bytes, as nanopb's generator computes it.

A message has a largest size if the size of every field has a limit, and if every message inside has a largest size. So
the innermost messages are computed first. A message that contains itself, or contains such a message, has none.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from graphlib import CycleError, TopologicalSorter

from roverlink.generator import ir
from roverlink.generator.diagnostics import Span
from roverlink.generator.nanopb.bounded_field import BoundedField, fields_of, varint_size
from roverlink.generator.nanopb.bounds import Bounds, FieldBounds
from roverlink.generator.nanopb.table_bounds import as_options
from roverlink.generator.protos.schema import ProtoMessage, Schema
from roverlink.generator.table import Table


@dataclass(frozen=True, slots=True)
class Unbounded:
    """The reason why the encoded size of a message has no limit."""

    path: str
    """Path, with dots, to the first field without a limit; empty if nanopb leaves the message out."""
    reason: str
    span: Span
    """Place of the field without a limit. For a field of a map's entry, this is the map's place."""


def row_sizes(table: Table, schema: Schema, given: Iterable[ir.FieldBound]) -> dict[str, ir.WireSize]:
    """Return the largest encoded sizes of each row's payload and datagram, by the row's name.

    Only ``given``, the size limits in mapping.yaml, are used. Limits in .options files are ignored: only an installed
    nanopb can read them, and mapping.yaml has to give the same generated files on every machine.
    """
    bounds = Bounds(fields={(bound.message, bound.field): FieldBounds(**as_options(bound)) for bound in given})
    sizes = {}
    for row in (row for row in table.rows if row.proto in schema.messages):
        payload = largest_size(schema, bounds, row.proto)
        if isinstance(payload, Unbounded):
            sizes[row.name] = ir.WireSize(None, None, payload.path)
        else:
            datagram = envelope_size(schema, bounds, table.envelope.message, row.number, payload)
            sizes[row.name] = ir.WireSize(payload, datagram)
    return sizes


def largest_size(schema: Schema, bounds: Bounds, message: str) -> int | Unbounded:
    """Return the largest encoded size of a message in bytes, or an `Unbounded` with the reason why it has no limit.

    ``message`` is a full name, and ``bounds`` belong to this schema. The result equals nanopb's ``<Message>_size``.
    Like nanopb, this does not count extensions.
    """
    sizes = _sizes(schema, bounds)
    return sizes[message] if message in sizes else _first_gap(schema, bounds, sizes, message)


def envelope_size(schema: Schema, bounds: Bounds, envelope: str, number: int, payload: int) -> int:
    """Return the largest encoded size of an envelope with one payload, in bytes.

    ``payload`` is the size of the payload in bytes, and ``number`` is its field number in the envelope. Fields of the
    envelope outside of the oneof are counted too.
    """
    # The tag, the length and the payload of the oneof's member, and every other field of the envelope at its largest.
    message = schema.messages.get(envelope)
    alone = {field.name for field in message.fields if not field.oneof} if message else set()
    beside = sum(size for name, size in field_sizes(schema, bounds, envelope) if name in alone) if alone else 0
    return varint_size(number << 3) + varint_size(payload) + payload + beside


def field_sizes(schema: Schema, bounds: Bounds, message: str) -> list[tuple[str, int]]:
    """Return the name and the largest encoded size in bytes of each field whose size has a limit, the largest first.

    All members of a oneof are listed, although only the largest one counts for the message.
    """
    sizes = _sizes(schema, bounds)
    found = [
        (field.field.name, field.size(schema, sizes))
        for field in fields_of(schema.messages[message], bounds)
        if not field.gap(schema, bounds) and (not field.inner or field.inner in sizes)
    ]
    return sorted(found, key=lambda named: (-named[1], named[0]))


def _sizes(schema: Schema, bounds: Bounds) -> Mapping[str, int]:
    """Return the largest encoded size in bytes of every message whose size has a limit, by full name."""
    if not bounds.sizes:
        bounds.sizes.append(_from_the_innermost(schema, bounds))
    return bounds.sizes[0]


def _from_the_innermost(schema: Schema, bounds: Bounds) -> dict[str, int]:
    inner = _inner_messages(schema, bounds)
    order, sizes = TopologicalSorter(inner), dict[str, int]()
    with contextlib.suppress(CycleError):  # the sorter still returns all messages that are not behind a cycle
        order.prepare()
    while ready := order.get_ready():
        for name in ready:
            if name in inner and inner[name] <= sizes.keys():
                sizes[name] = _message_size(schema.messages[name], schema, bounds, sizes)
        order.done(*ready)
    return sizes


def _message_size(message: ProtoMessage, schema: Schema, bounds: Bounds, known: Mapping[str, int]) -> int:
    """Return the largest encoded size of a message in bytes. The sizes of all its fields must have a limit.

    ``known`` has the largest sizes of the messages in its fields, by full name.
    """
    total = 0
    largest: dict[str, int] = {}
    for field in fields_of(message, bounds):
        size = field.size(schema, known)
        if field.in_union:
            largest[field.field.oneof] = max(largest.get(field.field.oneof, 0), size)
        else:
            total += size
    return total + sum(largest.values())


def _inner_messages(schema: Schema, bounds: Bounds) -> dict[str, set[str]]:
    """Return the full names of the messages in the fields of a message, by the full name of that message.

    A message is left out if one of its own fields has no size limit.
    """
    found: dict[str, set[str]] = {}
    for message in schema.messages.values():
        fields = list(fields_of(message, bounds))
        skipped = bounds.of_message(message.full_name).skipped
        if not skipped and not any(field.gap(schema, bounds) for field in fields):
            found[message.full_name] = {field.inner for field in fields if field.inner}
    return found


def _first_gap(schema: Schema, bounds: Bounds, sizes: Mapping[str, int], message: str) -> Unbounded:
    """Return the reason why a message has no largest size: the first field without a limit, at any depth."""
    span = schema.messages[message].span
    if bounds.of_message(message).skipped:
        return Unbounded("", f"nanopb leaves the message {message!r} out", span)
    passed: dict[str, str] = {}  # the path: each message with the field that leads to the next one
    while message not in passed:
        field, reason = _gap_of(schema, bounds, sizes, message)
        passed[message] = field.field.name
        if field.field.span.line:  # protoc gives no place to the fields of a map's entry, which it makes itself
            span = field.field.span
        if reason:
            return Unbounded(".".join(passed.values()), reason, span)
        message = field.inner
    names = [*passed]
    cycle = " > ".join([*names[names.index(message) :], message])
    return Unbounded(".".join(passed.values()), f"the message contains itself: {cycle}", span)


def _gap_of(schema: Schema, bounds: Bounds, sizes: Mapping[str, int], message: str) -> tuple[BoundedField, str]:
    """Return the first field that leaves the encoded size of a message without a limit, and the reason.

    The reason is, for example, that the field is a string without `max_size`. It is empty if the cause is not in the
    field itself, but inside the nested message that the field contains.
    """
    for field in fields_of(schema.messages[message], bounds):
        reason = field.gap(schema, bounds)
        if reason or (field.inner and field.inner not in sizes):
            return field, reason
    raise AssertionError(f"{message} has a size")  # callers check this first
