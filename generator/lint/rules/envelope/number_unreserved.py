"""A number that was used in the past is not reserved in the envelope.

Boards that send the old payload may still be in use. If a new payload gets the number, the rover mistakes the old
payload for the new one. This rule checks an envelope of another repository (`owner: proto`), and with `--history` that
of a tree without a table. If the table owns the envelope (`owner: mapping`), an entry under `retired` reserves the
number.

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

from collections.abc import Iterator, Set
from dataclasses import replace

from roverlink.generator.diagnostics import Diagnostic, Rule, Severity
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.history_diagnostics import use_of
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
            finding = _finding(envelope, number, entry.name, entry.proto)
            yield replace(finding, also=((entry.span, "published here"),))
    yield from _removed_in_history(context, envelope, published.keys())


def _removed_in_history(context: Context, envelope: ProtoMessage, known: Set[int]) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each free number that a tree without a table once used, according to git's history.

    A project with a table has a ledger, which knows the numbers that were published. It is a hint if the baseline had
    removed the number already. The numbers ``known`` are left out.
    """
    past = context.past
    if context.table.proto.root or past is None or not past.of_numbers:
        return
    # The last usage of a number counts, if it had several.
    removed = {usage.number: (usage, commits) for usage, commits in past.history.removed(envelope.full_name)}
    for number, (usage, commits) in sorted(removed.items()):
        if usage.oneof and number not in known and _is_free(number, envelope):
            found = _finding(envelope, number, usage.name, usage.type)
            finding = replace(found, uses=(use_of(context, usage),))
            before = any(commit.id in past.before for commit in commits)
            yield replace(finding, severity=Severity.HINT) if before else finding


def _finding(envelope: ProtoMessage, number: int, name: str, type: str) -> Diagnostic:
    message = f"field {number}, {name!r} ({type}), was removed, but its number is not reserved"
    help = f"add {_reservation(number, name, envelope)} to the message {envelope.full_name!r}"
    return RULE.at(envelope.at("name"), message, help, type=envelope.full_name, number=number)


def _is_free(number: int, envelope: ProtoMessage) -> bool:
    used = any(field.number == number for field in envelope.fields)
    return not used and not any(first <= number <= last for first, last in envelope.reserved)


def _reservation(number: int, name: str, envelope: ProtoMessage) -> str:
    """Return the statements with which the envelope can reserve the number and the name of a payload.

    A name that the envelope already reserves or uses is left out.
    """
    known = {*envelope.reserved_names, *(field.name for field in envelope.fields)}
    of_name = "" if name in known else f' and `reserved "{name}";`'
    return f"`reserved {number};`{of_name}"


def _is_of_another_rule(number: int, table: Table) -> bool:
    """Return True if another rule reports the number. This is so if the table uses it, or lost its row."""
    retired = number in {row.number for row in table.retired}
    return not retired and (table.whole or number in table.numbers)
