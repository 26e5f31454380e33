"""A number that was used in the past is not reserved in the envelope.

Boards that send the old payload may still be in use. If a new payload gets the number, the rover mistakes the old
payload for the new one. This rule checks an envelope of another repository (`owner: proto`). If the table owns the
envelope (`owner: mapping`), an entry under `retired` reserves the number.

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
    """Yield a diagnostic for each published number that the envelope neither uses nor reserves."""
    table = context.table
    envelope = context.schema.messages.get(table.envelope.message) if context.schema else None
    if envelope is None or table.envelope.owner != "proto":
        return
    # Several payloads may have been published with one number, but it is reserved once. The ledger's entry is kept.
    published = {entry.number: entry for entry in reversed(context.published)}
    for number, entry in sorted(published.items()):
        if _is_free(number, envelope) and not _is_of_another_rule(number, table):
            message = f"field {number}, {entry.name!r} ({entry.proto}), was removed, but its number is not reserved"
            help = f"add {_reservation(entry, envelope)} to the message {envelope.full_name!r}"
            also = [(entry.span, "published here")]
            yield RULE.at(envelope.at("name"), message, help, also, type=envelope.full_name, number=number)


def _is_free(number: int, envelope: ProtoMessage) -> bool:
    used = any(field.number == number for field in envelope.fields)
    return not used and not any(first <= number <= last for first, last in envelope.reserved)


def _reservation(entry: Entry, envelope: ProtoMessage) -> str:
    """Return the statements with which the envelope can reserve a payload's number and name.

    A name that the envelope already reserves or uses is left out.
    """
    known = {*envelope.reserved_names, *(field.name for field in envelope.fields)}
    of_name = "" if entry.name in known else f' and `reserved "{entry.name}";`'
    return f"`reserved {entry.number};`{of_name}"


def _is_of_another_rule(number: int, table: Table) -> bool:
    """Return True if another rule reports the number. This is so if the table uses it, or lost its row."""
    retired = number in {row.number for row in table.retired}
    return not retired and (table.whole or number in table.numbers)
