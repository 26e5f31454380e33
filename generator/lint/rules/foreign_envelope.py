"""Rules about what the envelope has to contain, above all if another repository owns it."""

from __future__ import annotations

from collections.abc import Iterator, Set
from dataclasses import replace

from roverlink.generator.diagnostics import Diagnostic
from roverlink.generator.ir import LINK_FIELDS
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.history_diagnostics import use_of
from roverlink.generator.lint.rules import LintRule
from roverlink.generator.protos.number_ranges import covers
from roverlink.generator.protos.schema import ProtoField, ProtoMessage
from roverlink.generator.table import Table


class PayloadOutsideOneof(LintRule, id="ENV106"):
    """A payload stands in the envelope outside of the oneof.

    The receiver looks at the member of the oneof that is set, and ignores everything beside it. Usually the payload was
    added one line too low, behind the oneof's closing brace. A number or a string beside the oneof is not a payload:
    envelopes of another repository may have them, such as a sequence number.

    Bad::

        message PBEnvelope {
          oneof payload {
            SensorBoardGPSInfo gps_info = 12;
          }
          SensorBoardIMUInfo imu_info = 13;
        }

    Good::

        message PBEnvelope {
          oneof payload {
            SensorBoardGPSInfo gps_info = 12;
            SensorBoardIMUInfo imu_info = 13;
          }
        }
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each message of the envelope that is outside of the oneof.

        If the table owns the envelope, each field of another type outside of the oneof is reported, too.
        """
        settings = context.table.envelope
        envelope = context.schema.messages.get(settings.message)
        if envelope is None or settings.oneof not in envelope.oneofs:
            return
        ours = settings.owner == "mapping"
        signing = context.table.signing
        for field in envelope.fields:
            if signing and (field.number, field.name) == (signing.number, signing.name):
                continue
            if field.oneof != settings.oneof and (ours or _is_payload(field)):
                message = (
                    f"`{field.name} = {field.number}` ({field.wire_type}) is outside of the oneof {settings.oneof!r}"
                )
                help = f"move {field.name!r} into the oneof {settings.oneof!r}"
                if ours:
                    help = (
                        "add a row for the payload, and run `roverlink generate`, which writes this file from the table"
                    )
                yield cls.at(field.span, message, help, type=envelope.full_name, number=field.number)


def _is_payload(field: ProtoField) -> bool:
    return field.type == "message" and not field.type_name.startswith("google.protobuf.")


class NumberUnreserved(LintRule, id="ENV107"):
    """A number that was used in the past is not reserved in the envelope.

    Boards that send the old payload may still be in use. If a new payload gets the number, the rover mistakes the old
    payload for the new one. This rule checks an envelope of another repository (`owner: proto`), and with `--history`
    that of a tree without a table. If the table owns the envelope (`owner: mapping`), an entry under `retired` reserves
    the number. If the number was retired and free at the last `roverlink generate` already, the diagnostic is a hint:
    the table then never gives the number to another row, also if nobody can change the envelope.

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

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each published number that the envelope neither uses nor reserves."""
        table = context.table
        envelope = context.schema.messages.get(table.envelope.message)
        if envelope is None or table.envelope.owner != "proto":
            return
        # Several payloads may have been published with one number, but it is reserved once. The ledger's entry is kept.
        published = {entry.number: entry for entry in reversed(context.published)}
        for number, entry in sorted(published.items()):
            if _is_free(number, envelope) and not _is_of_another_rule(number, table):
                found = _removal(envelope, number, entry.name, entry.proto)
                finding = replace(found, also=((entry.span, "published here"),))
                # The ledger is a baseline, too: the number was free there already, and the table keeps it retired.
                before = context.ledger.schema.messages.get(envelope.full_name)
                known = entry.retired and before is not None and _is_free(number, before)
                yield finding.as_known() if known else finding
        yield from _removed_in_history(context, envelope, published.keys())


def _removed_in_history(context: Context, envelope: ProtoMessage, known: Set[int]) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each free number that a tree without a table once used, according to git's history.

    A project with a table has a ledger, which knows the numbers that were published. The numbers ``known`` are left
    out.
    """
    past = context.past
    if context.table.proto.root or past is None or not past.of_numbers:
        return
    # The last usage of a number counts, if it had several.
    removed = {usage.number: (usage, commits) for usage, commits in past.history.removed(envelope.full_name)}
    for number, (usage, commits) in sorted(removed.items()):
        if usage.oneof and number not in known and _is_free(number, envelope):
            found = _removal(envelope, number, usage.name, usage.type)
            finding = replace(found, uses=(use_of(context, usage),))
            # Both sides of a merge may have removed it: it was free in the baseline if one of them is not new.
            yield finding.as_known() if any(map(past.is_known, commits)) else finding


def _removal(envelope: ProtoMessage, number: int, name: str, type: str) -> Diagnostic:
    message = f"field {number}, {name!r} ({type}), was removed, but its number is not reserved"
    help = f"add {_reservation(number, name, envelope)} to the message {envelope.full_name!r}"
    return NumberUnreserved.at(envelope.at("name"), message, help, type=envelope.full_name, number=number)


def _is_free(number: int, envelope: ProtoMessage) -> bool:
    used = any(field.number == number for field in envelope.fields)
    return not used and not covers(envelope.reserved, number)


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


class LinkMessageMissing(LintRule, id="LNK101"):
    """The envelope of another repository does not have the link message that the table has under `link`.

    If the table owns the envelope's file (`owner: mapping`), `roverlink generate` writes the link message's file and
    the member of the envelope. If another repository owns it (`owner: proto`), that repository has to declare both, as
    below. Field names, numbers and types must be these, because all programs that use the link message share them.

    Bad::

        # mapping.yaml
        envelope: {file: envelope.proto, message: Envelope, oneof: payload, owner: proto}
        link: {number: 22}

        # envelope.proto
        message Imu { float x = 1; }
        message Envelope {
          oneof payload {
            Imu imu = 1;
          }
        }

    Good::

        # mapping.yaml
        envelope: {file: envelope.proto, message: Envelope, oneof: payload, owner: proto}
        link: {number: 22}

        # envelope.proto
        import "link.proto";
        message Imu { float x = 1; }
        message Envelope {
          oneof payload {
            Imu imu = 1;
            roverlink.Link link = 22;
          }
        }

        # link.proto
        syntax = "proto3";
        package roverlink;
        message Link {
          uint32 session = 1;
          uint32 sequence = 2;
          uint32 sent = 3;
          uint32 received = 4;
          uint64 time_us = 5;
          uint64 echo_us = 6;
          uint32 echo_age_us = 7;
          repeated uint32 numbers = 8;
          repeated fixed32 hashes = 9;
        }
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic if the envelope lacks the link message, or if the link message has other fields."""
        table, link = context.table, context.table.link
        envelope = context.schema.messages.get(table.envelope.message)
        if envelope is None or link is None or table.envelope.owner != "proto":
            return
        member = f"{link.proto} {link.name} = {link.number};"
        found = [field for field in envelope.fields if link.number == field.number or link.name == field.name]
        declared = context.schema.messages.get(link.proto)
        facts = [(field.number, field.name, field.wire_type, field.oneof) for field in found]
        if facts != [(link.number, link.name, link.proto, table.envelope.oneof)]:
            message = f"the oneof {table.envelope.oneof!r} of the envelope has no member `{member}`"
            help = f"add the member and link.proto in the envelope's repository, as `roverlink explain {cls.id}` shows"
            also = [(field.span, "the member is here") for field in found]
            yield cls.of_row(table, link, "number", message, help, also)
        elif declared is not None and declared.on_the_wire().fields != LINK_FIELDS:
            message = f"the message {link.proto} has other fields than the link message"
            help = f"give it the fields that `roverlink explain {cls.id}` shows"
            yield cls.of_row(table, link, declared.span, message, help)
