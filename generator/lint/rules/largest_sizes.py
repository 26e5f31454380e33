"""Rules about the largest sizes of payloads and their numbers."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Severity
from roverlink.generator.ir import largest_link_size
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.rules import LintRule
from roverlink.generator.nanopb import Bounds, Unbounded, envelope_size, field_sizes, largest_size
from roverlink.generator.node_parameters import largest_accepted
from roverlink.generator.protos.schema import ProtoMessage, Schema
from roverlink.generator.table import PeerSettings, Row
from roverlink.transport_addresses import largest_datagram

_HELP_BOUND = (
    "set max_length (string), max_size (bytes) or max_count (repeated) in a .options file beside the .proto file"
)


class FieldUnbounded(LintRule, id="FIX101"):
    """A payload of a microcontroller has a field without a bound, which is the limit of its size.

    A peer with `max_size` has fixed buffers. So nanopb's options beside the .proto file must limit the length of each
    string and the count of each repeated field. Without a bound, nanopb cannot reserve memory for the field, and the
    largest size of the envelope is unknown.

    Bad::

        // note.proto
        message Note {
          string text = 1;
        }

    Good::

        # note.options
        Note.text max_length:20
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each payload with an unlimited field, if a sender or receiver has a `max_size`."""
        schema, bounds = context.schema, context.bounds
        if bounds is None:
            return
        for proto, (row, peer) in _limited(context).items():
            found = largest_size(schema, bounds, proto) if proto in schema.messages else 0
            if isinstance(found, Unbounded):
                first, _, _ = found.path.partition(".")
                number = next((field.number for field in schema.messages[proto].fields if field.name == first), None)
                field = f"{proto}.{found.path}" if found.path else proto
                message = f"{field!r} has no largest size: {found.reason}"
                also = [(row.at("proto"), f"the peer {peer.name!r} accepts at most {peer.max_size} bytes")]
                yield cls.at(found.span, message, _HELP_BOUND, also, type=proto, number=number)


def _limited(context: Context) -> dict[str, tuple[Row, PeerSettings]]:
    """Return the payloads whose sender or receiver has a `max_size`, each with its first row and this peer."""
    peers = context.table.peers_by_name()
    found: dict[str, tuple[Row, PeerSettings]] = {}
    for row in context.table.rows:
        for name in (row.peer, *row.forward):
            if name in peers and peers[name].max_size is not None:
                found.setdefault(row.proto, (row, peers[name]))
    return found


_HELP_SIZE = "lower a limit in the .options file, split the message, or raise `max_size` if the peer has the memory"


class EnvelopeTooLarge(LintRule, id="FIX102"):
    """An envelope can become larger than a peer accepts.

    A peer with `max_size` has a buffer of that many bytes, and cuts off or drops a larger datagram. This happens only
    if the values are long, so a short test often does not show it.

    Bad::

        peers:
          board: {max_size: 32}
        # note.options
        Note.text max_length:40

    Good::

        # note.options
        Note.text max_length:20
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each row whose largest envelope exceeds the `max_size` of its sender or receiver."""
        table, schema, bounds = context.table, context.schema, context.bounds
        if bounds is None:
            return
        peers = table.peers_by_name()
        for row, size in _envelope_sizes(context, bounds):
            for peer in (peers[name] for name in (row.peer, *row.forward) if name in peers):
                if peer.max_size is not None and size > peer.max_size:
                    largest = _largest_fields(row, schema, bounds)
                    message = f"envelopes with {row.name!r} have up to {size} bytes"
                    message = f"{message}; the peer {peer.name!r} accepts at most {peer.max_size}"
                    also = [(peer.at("max_size"), "the limit is here")]
                    text = f"{message}; {largest}"
                    yield cls.of_row(table, row, "proto", text, _HELP_SIZE, also)
        if link := table.link:
            size = envelope_size(schema, bounds, table.envelope.message, link.number, largest_link_size())
            for peer in table.peers:
                if peer.max_size is not None and size > peer.max_size:
                    message = f"the link message has up to {size} bytes; the peer {peer.name!r} accepts at most"
                    help = "raise `max_size` if the peer has the memory, or remove `link`"
                    also = [(peer.at("max_size"), "the limit is here")]
                    yield cls.of_row(table, link, table.at("link"), f"{message} {peer.max_size}", help, also)


def _envelope_sizes(context: Context, bounds: Bounds) -> Iterator[tuple[Row, int]]:
    """Yield each row with the size of its largest envelope, if it has a limit; FIX101 reports the others."""
    table, schema = context.table, context.schema
    for row in table.rows:
        payload = largest_size(schema, bounds, row.proto) if row.proto in schema.messages else None
        if isinstance(payload, int):
            yield row, envelope_size(schema, bounds, table.envelope.message, row.number, payload)


def _largest_fields(row: Row, schema: Schema, bounds: Bounds) -> str:
    first, *more = field_sizes(schema, bounds, row.proto)[:3] or [("nothing", 0)]
    return ", ".join(
        [f"the largest parts are {first[0]!r} ({first[1]} bytes)", *(f"{name!r} ({size})" for name, size in more)]
    )


class EnvelopeTooLargeForTransport(LintRule, id="FIX105"):
    """An envelope can become larger than the transport to its peer or board carries.

    A datagram has at most 65,507 bytes over UDP and TCP, 4096 over a serial line, and 4095 over CAN. The bridge drops
    and counts a larger one. It also drops what comes from a peer and has more than 1472 bytes. This is a warning,
    because the parameter `max_datagram` can raise this limit.

    Bad::

        peers:
          board: {host: "can:can0?send=0x101&receive=0x102"}
        # note.options
        Note.text max_length:5000

    Good::

        # note.options
        Note.text max_length:1400
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each row and each end that gets or sends it, if the transport is too small."""
        if context.bounds is None:
            return
        peers = context.table.peers_by_name()
        for row, size in _envelope_sizes(context, context.bounds):
            board = context.table.board_of(row)
            for peer in (peers[name] for name in (row.peer, *row.forward) if name in peers):
                for settings, end in peer.ends:
                    is_of_row = peer.name != row.peer or not peer.boards or end.name == board
                    carried = min(map(largest_datagram, settings.hosts or ("",)))
                    accepted = largest_accepted() if row.inbound and peer.name == row.peer else carried
                    if not is_of_row or size <= min(carried, accepted):
                        continue
                    message = f"envelopes with {row.name!r} have up to {size} bytes"
                    help, also = "lower a limit in the .options file, or split the message", []
                    if carried <= accepted:
                        message = f"{message}; the transport to {end.name!r} carries at most {carried}"
                        also = [(settings.at("host"), "the transport is named here")] if settings.hosts else []
                    else:
                        message = f"{message}; the bridge accepts at most {accepted} from {end.name!r}"
                        help = f"{help}, or start the bridge with a larger parameter `max_datagram`"
                    found = cls.of_row(context.table, row, "proto", message, help, also)
                    yield found if size > carried else dataclasses.replace(found, severity=Severity.WARNING)


_LAST_SHORT = 15


class NumberAbove15(LintRule, id="FIX104", severity=Severity.HINT):
    """A microcontroller sends fields with numbers above 15.

    The number and the wire type of a field take one byte up to number 15, and two bytes from 16 on (encoding guide,
    "Message Structure"). A board that sends a message many times a second over a slow link sends this byte every time.
    Choose small numbers for a new message, because published numbers must not change later.

    Bad::

        message Sample {
          float x = 16;
        }

    Good::

        message Sample {
          float x = 1;
        }
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each message with a field number above 15 that a peer with `max_size` sends."""
        table, schema = context.table, context.schema
        limited = {peer.name for peer in table.peers if peer.max_size is not None}
        sent = [row.proto for row in table.rows if row.inbound and row.peer in limited]
        for name in sorted(schema.reachable(*sent)[0]):
            yield from _long_numbers(schema.messages[name])


def _long_numbers(message: ProtoMessage) -> Iterator[Diagnostic]:
    long = sorted((field for field in message.fields if field.number > _LAST_SHORT), key=lambda field: field.number)
    if not long:
        return
    used = {field.number for field in message.fields}
    used |= {number for first, last in message.reserved for number in range(first, min(last, _LAST_SHORT) + 1)}
    free = [number for number in range(1, _LAST_SHORT + 1) if number not in used]
    named = [f"`{field.name} = {field.number}`" for field in long[:3]] + ["..."] * (len(long) > 3)
    text = f"field numbers above {_LAST_SHORT} take one more byte in each message: {', '.join(named)}"
    unused = (
        f"in a new message, use the free number {free[0]}"
        if free
        else "in a new message, give these numbers to the rarest fields"
    )
    help = f"{unused}; never change a published number"
    yield NumberAbove15.at(long[0].at("number"), text, help, type=message.full_name, number=long[0].number)
