"""Safety settings of rows and peers: the payload that stops the rover, the rate limits, and the priority."""

from __future__ import annotations

import math
import struct
from collections.abc import Callable, Iterator

from roverlink.generator import ir
from roverlink.generator.diagnostics import Diagnostic, Span
from roverlink.generator.protos.schema import ProtoField, ProtoMessage, Schema
from roverlink.generator.resolve import numeric_ranges
from roverlink.generator.resolve.safety_rules import (
    MisplacedGuard,
    RateSlowerThanDeadman,
    RateWithoutSources,
    SendWithDeadman,
    SignWithoutSigning,
    StopValue,
    UnknownStopField,
)
from roverlink.generator.resolve.well_known import SCALARS
from roverlink.generator.table import DeadmanSettings, Row, Table
from roverlink.numerals import counted
from roverlink.suggestions import nearest

Value = bool | int | float | str | bytes

# The largest uint64 has 20 digits. int() takes quadratic time, and raises for more than 4,300 digits.
_LONGEST_NUMBER = 40  # characters


def deadman(row: Row, schema: Schema, report: Callable[[Diagnostic], None]) -> ir.Deadman | None:
    """Return the deadman of a row: the payload that the bridge sends to a peer when the row's topic is silent too long.

    Reports mistakes in the row's safety settings: deadman, limits and priority.
    """
    for finding in (*_misplaced(row), *_too_slow(row)):
        report(finding)
    return _deadman(row.deadman, row, schema, report) if row.deadman else None


def check_peers(table: Table) -> Iterator[Diagnostic]:
    """Report each peer that has a `source_rate`, but no `sources`, and each that must sign without `signing`.

    `source_rate` is the largest number of datagrams per second from each IP address that `sources` allows.
    """
    for peer in table.peers:
        if peer.sign and table.signing is None and "signing" not in table.spans:
            message = f"datagrams of the peer {peer.name!r} must be signed, but the table has no `signing`"
            help = "add `signing: {number: N}`; `roverlink number next` prints the number"
            yield SignWithoutSigning.at(peer.at("sign"), message, help)
        if peer.source_rate is not None and not peer.sources:
            message = f"the peer {peer.name!r} has a `source_rate`, but no `sources`"
            help = "list its `sources`; [0.0.0.0/0] allows any address"
            yield RateWithoutSources.at(peer.at("source_rate"), message, help)


def _misplaced(row: Row) -> Iterator[Diagnostic]:
    outgoing = [key for key in ("deadman", "send", "priority") if key in row.spans]
    if row.inbound and row.forward and "priority" in outgoing:
        outgoing.remove("priority")
    if row.inbound and outgoing:
        keys, one = " and ".join(f"`{key}`" for key in outgoing), len(outgoing) == 1
        message = (
            f"the direction of {row.name!r} is {row.direction!r}, but {keys} {'is' if one else 'are'} for topics that "
        )
        message += "are sent to a peer"
        help = f"write `direction: ros_to_{row.peer}`, or remove {keys}"
        also = [(row.at(key), f"`{key}` is set here") for key in outgoing]
        yield MisplacedGuard.at(row.at("direction"), message, help, also)
    if not row.inbound and row.also and row.deadman:
        message = (
            f"{row.name!r} has extra topics under `also`, so `deadman` could stop the peer while one topic is active"
        )
        yield MisplacedGuard.at(
            row.at("deadman"), message, "remove `also` or `deadman`; only one topic should command the peer"
        )
    if not row.inbound and row.also and row.send:
        message = f"{row.name!r} has extra topics under `also`, so `send` could repeat the old message of another topic"
        yield MisplacedGuard.at(row.at("send"), message, "remove `also` or `send`")
    if row.send and row.deadman:
        message = f"{row.name!r} has `send`, so its topic may be silent, but `deadman` then stops the peer"
        also = [(row.at("deadman"), "the deadman is here")]
        yield SendWithDeadman.at(row.at("send"), message, "remove `send` or `deadman`", also)


def _too_slow(row: Row) -> Iterator[Diagnostic]:
    """Report a rate limit that is so low that the topic counts as silent between two messages."""
    if row.deadman and row.max_rate and 1000 / row.max_rate >= row.deadman.after_ms:
        silent = f"counts as silent after {row.deadman.after_ms} ms"
        message = f"{row.name!r} has at most {counted(row.max_rate, 'message')} a second, but {silent}"
        also = [(row.deadman.at("after"), "this time is set here")]
        yield RateSlowerThanDeadman.at(row.at("max_rate"), message, "raise `max_rate` or `after`", also)


def _deadman(settings: DeadmanSettings, row: Row, schema: Schema, report: Callable[[Diagnostic], None]) -> ir.Deadman:
    values: list[tuple[str, Value]] = []
    for path, text in settings.send.items():
        span = settings.at(f"send.{path}")
        field = _field(schema.messages[row.proto], path, schema, span, report)
        if field is None:
            continue
        value, wanted = _value(field, text, schema)
        if value is None:
            message = f"{path!r} of {row.name!r} cannot be {text!r}; it must be {wanted}"
            report(StopValue.at(span, message, "write the value that stops the peer"))
        else:
            values.append((path, value))
    return ir.Deadman(settings.after_ms, settings.repeat_ms, tuple(values))


def _field(
    message: ProtoMessage, path: str, schema: Schema, span: Span, report: Callable[[Diagnostic], None]
) -> ProtoField | None:
    """Return the proto field at the end of a path; if there is no such field, report the path and return None."""
    *outer, name = path.split(".")
    for part in outer:
        field = _member(message, part, path, span, report)
        if field is None:
            return None
        if field.type not in ("message", "group") or field.repeated:
            fault = f"{part!r} in the path {path!r} is not a nested message"
            report(UnknownStopField.at(span, fault, f"end the path at {part!r}, or correct it"))
            return None
        message = schema.messages[field.type_name]
    return _member(message, name, path, span, report)


def _member(
    message: ProtoMessage, name: str, path: str, span: Span, report: Callable[[Diagnostic], None]
) -> ProtoField | None:
    fields = {field.name: field for field in message.fields}
    if name not in fields:
        help = nearest(name, fields, f"known fields: {', '.join(fields)}" if fields else "this message has no fields")
        report(
            UnknownStopField.at(
                span, f"the path {path!r} is wrong: the proto message {message.full_name!r} has no field {name!r}", help
            )
        )
    return fields.get(name)


def _value(field: ProtoField, text: str, schema: Schema) -> tuple[Value | None, str]:
    """Convert a text from the table to a value of a proto field, and return it with a text about the values that fit.

    The value is None if the text does not fit the field. The second result is for the diagnostic in this case:
    ``true or false``, ``one of OFF, ON``.
    """
    if field.repeated:
        return None, "an empty list, so remove it"
    if field.type in ("message", "group"):
        return None, "given by the message's fields, with dots in the path"
    if field.type == "enum":
        values = {value.name: value.number for value in schema.enums[field.type_name].values}
        return values.get(text), f"one of {', '.join(values)}"
    if field.type == "bool":
        return {"true": True, "false": False}.get(text), "true or false"
    if field.type == "string":
        return text, "a text"
    if field.type == "bytes":
        return _bytes(text), "bytes in hexadecimal"
    return _number(field.type, text), f"a {field.type}"


def _bytes(text: str) -> bytes | None:
    try:
        return bytes.fromhex(text)
    except ValueError:
        return None


def _number(type: str, text: str) -> int | float | None:
    kind = SCALARS[type]
    try:
        if room := numeric_ranges.range_of(kind):
            number = int(text) if len(text) <= _LONGEST_NUMBER else None
            return number if number is not None and room[0] <= number <= room[1] else None
        value = float(text)
        # Raises OverflowError for a double that is too large for a float. Before Python 3.14, a native "f" does not.
        struct.pack("<f" if kind == "float32" else "<d", value)
    except (ValueError, OverflowError):
        return None
    return value if math.isfinite(value) else None
