"""A number that was used in the past is free in the envelope.

Boards that send it are out there. As long as nothing reserves it, the next payload may get it, and be taken for the old
one. Where the table owns the envelope, retiring a payload reserves its number; this finds those of an envelope that
somebody else keeps.

Bad::

    message PBEnvelope {
      oneof payload {
        SensorBoardIMUInfo imu_info = 13;  // 12 was SensorBoardGPSInfo
      }
    }

Good::

    message PBEnvelope {
      reserved 12;
      reserved "gps_info";
      oneof payload {
        SensorBoardIMUInfo imu_info = 13;
      }
    }
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule
from roverlink.generator.lint.context import Context
from roverlink.generator.lock import Entry
from roverlink.generator.protos.schema import ProtoMessage
from roverlink.generator.table import Table

RULE = Rule("ENV107", "number-unreserved", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Numbers that were published, and that the envelope neither has nor reserves."""
    table = context.table
    envelope = context.schema.messages.get(table.envelope.message) if context.schema else None
    if envelope is None or table.envelope.owner != "proto":
        return
    # One number may be known from several places and for several payloads, the ledger first; it is reserved once.
    published = {entry.number: entry for entry in reversed(context.published)}
    for number, entry in sorted(published.items()):
        if _is_free(number, envelope) and not _is_of_another_rule(number, table):
            message = f"field {number} was {entry.name} ({entry.proto}); nothing keeps another payload from getting it"
            help = f"add {_reservation(entry, envelope)} to {envelope.full_name}"
            also = [(entry.span, "published here")]
            yield RULE.at(envelope.at("name"), message, help, also, type=envelope.full_name, number=number)


def _is_free(number: int, envelope: ProtoMessage) -> bool:
    used = any(field.number == number for field in envelope.fields)
    return not used and not any(first <= number <= last for first, last in envelope.reserved)


def _reservation(entry: Entry, envelope: ProtoMessage) -> str:
    """What reserves a number, and its name, unless that is reserved or went along to another field."""
    known = {*envelope.reserved_names, *(field.name for field in envelope.fields)}
    of_name = "" if entry.name in known else f' and `reserved "{entry.name}";`'
    return f"`reserved {entry.number};`{of_name}"


def _is_of_another_rule(number: int, table: Table) -> bool:
    """Whether the number is in use in the table, or missing there: faults of their own, which other rules find."""
    retired = number in {row.number for row in table.retired}
    return not retired and (table.whole or number in table.numbers)
