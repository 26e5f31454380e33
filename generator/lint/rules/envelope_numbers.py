"""Rules about the numbers of the payloads in the envelope."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Iterator

from roverlink.generator.diagnostics import Diagnostic, Severity, Span
from roverlink.generator.ir.protobuf_facts import IMPLEMENTATION_NUMBERS
from roverlink.generator.lint.comparison.judged_changes import judge_payload
from roverlink.generator.lint.comparison.judgement import Judgement, Meaning, least
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.rules import LintRule
from roverlink.generator.lock import NAME, Entry, PastUse
from roverlink.generator.table import Numbered, RetiredRow, Table


class FieldNumberTaken(LintRule, id="ENV101"):
    """Two payloads of the envelope have the same field number.

    The receiver cannot tell the two payloads apart. A retired number is taken forever, because boards that send the old
    payload may still be in use.

    Bad::

        messages:
          - {number: 12, name: gps_info, proto: SensorBoardGPSInfo, topic: gps_data, direction: hardware_to_ros}
          - {number: 12, name: wind, proto: SensorBoardWind, topic: wind, direction: hardware_to_ros}

    Good::

        messages:
          - {number: 12, name: gps_info, proto: SensorBoardGPSInfo, topic: gps_data, direction: hardware_to_ros}
          - {number: 22, name: wind, proto: SensorBoardWind, topic: wind, direction: hardware_to_ros}
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each row, retired row and signature whose number belongs to another row."""
        table = context.table
        holders: dict[int, RetiredRow] = {}

        def at(row: Numbered | RetiredRow, message: str, help: str, also: tuple[Span, str]) -> Diagnostic:
            return cls.of_row(table, row, "number", message, help, [also])

        for retired in table.retired:
            first = holders.setdefault(retired.number, retired)
            if first is not retired:
                message = f"field {retired.number} is retired twice"
                yield at(retired, message, "keep one of the two entries", (first.at("number"), "first retired here"))
        rows = _owners(context)
        published = {(entry.proto, entry.name): entry.number for entry in context.published}
        next_number = context.next_number()
        for row in table.numbered:
            old = published.get((row.proto, row.name))
            help = f"use {next_number}, the next number that was never used"
            if old is not None and old not in table.numbers:
                help = f"give {row.name!r} back its published number {old}"
            if row.number in holders:
                gone = holders[row.number]
                message = f"field {row.number} was {gone.name!r} ({gone.proto}) and is retired"
                yield at(row, message, help, (gone.at("number"), "retired here"))
            elif rows[row.number] is not row:
                taken = rows[row.number]
                message = f"field {row.number} is already taken by {taken.name!r} ({taken.proto})"
                yield at(row, message, help, (taken.at("number"), "first used here"))


def _owners(context: Context) -> dict[int, Numbered]:
    """Return the owner of each number: the row for which it was published, or else the first row that has it."""
    owners: dict[int, Numbered] = {}
    published = {(entry.number, entry.proto) for entry in context.published}
    # The row that had the number first is right, even if the other one stands above it in the file.
    for row in sorted(context.table.numbered, key=lambda row: (row.number, row.proto) not in published):
        owners.setdefault(row.number, row)
    return owners


class FieldNumberReuse(LintRule, id="ENV102"):
    """A published field number is given to another payload.

    An old board and a new rover would decode each other's bytes as the wrong message, without an error. A number is
    published when `roverlink generate` writes it to the ledger (mapping.lock), which keeps all numbers forever. With
    `--against`, the numbers of the earlier state count as published, too. An entry under `retired` must name the
    payload that had the number.

    A message that only has another name is the same payload. If this is not certain, the diagnostic is a warning
    (`roverlink explain WIR116`).

    Bad::

        # mapping.lock says `12: gps_info SensorBoardGPSInfo`
        messages:
          - {number: 12, name: wind, proto: SensorBoardWind, topic: wind, direction: hardware_to_ros}

    Good::

        messages:
          - {number: 22, name: wind, proto: SensorBoardWind, topic: wind, direction: hardware_to_ros}
        retired:
          - {number: 12, name: gps_info, proto: SensorBoardGPSInfo}
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each row, retired row and signature whose number was published for another message."""
        # The ledger and the baseline may list the same payload. The ledger comes first, so its entry is kept.
        published = {(entry.number, entry.proto): entry for entry in reversed(context.published)}
        for row in context.table.numbered:
            for entry in _others(row, published.values()):
                keep = (
                    f"keep the row of {entry.name!r}, or move that row to `retired`"
                    if context.table.proto.root
                    else f"keep {entry.name!r}, or write `reserved {entry.number};`"
                )
                help = f"give {row.name!r} the number {context.next_number()}; {keep}"
                yield from _judged(context, row, entry, _reuse(row, entry, help, context.table))
        for retired in context.table.retired:
            for entry in _others(retired, published.values()):
                help = f"write under `retired`: {{number: {entry.number}, name: {entry.name}, proto: {entry.proto}}}"
                yield _reuse(retired, entry, help, context.table)


def _others(row: Numbered | RetiredRow, published: Iterable[Entry]) -> Iterator[Entry]:
    """Yield the published payloads that had the number of a row, and are not the row's payload."""
    entries = [entry for entry in published if entry.number == row.number]
    for_this = any(entry.proto == row.proto for entry in entries)
    for entry in entries:
        # If two branches took the same number, the merged table decides which payload keeps it. `generate` publishes a
        # number for a second payload only if this is the first one with another name.
        settled = for_this and (entry.contested or entry.gone)
        if entry.proto != row.proto and not settled:
            yield entry


def _judged(context: Context, row: Numbered, entry: Entry, finding: Diagnostic) -> Iterator[Diagnostic]:
    """Yield the diagnostic, as a warning if in doubt.

    Yield nothing if the row's message is the published one, renamed, or if the user has accepted the change.
    """
    old, new = PastUse(entry.proto, entry.name), PastUse(row.proto, row.name)
    if context.ledger.settles(context.table.envelope.message, row.number, old, new):
        return
    judged = (judge_payload(change, entry.proto, row.proto, entry.name, row.name) for change in context.changes)
    found = least([judgement for judgement in judged if judgement] or [Judgement(Meaning.OTHER)])
    if found.certain:
        yield finding
    elif found.meaning is not Meaning.RENAMED:
        message = f"{finding.message}: {found.reason}"
        yield dataclasses.replace(finding, severity=Severity.WARNING, message=message)


def _reuse(row: Numbered | RetiredRow, entry: Entry, help: str, table: Table) -> Diagnostic:
    message = f"field {row.number} was published for {entry.name!r} ({entry.proto}), but is given to {row.proto} here"
    also = [(entry.span, "published here")]
    rests_on = [row.at("number"), row.at("proto")]
    return FieldNumberReuse.of_row(table, row, "number", message, help, also, rests_on)


class FieldNumberVanished(LintRule, id="ENV103"):
    """A published field number is neither in use nor retired.

    Its row was deleted, so the number looks free. If another payload gets it, the rover misreads boards that send the
    old payload. Move the row to `retired` instead, which reserves its number and its name.

    Bad::

        # mapping.lock says `12: gps_info SensorBoardGPSInfo`; no row has the number 12
        retired: []

    Good::

        retired:
          - {number: 12, name: gps_info, proto: SensorBoardGPSInfo}
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each published payload whose number no row and no retired row has."""
        table = context.table
        if not table.whole:
            return  # the missing number may be in a row that could not be read
        # The ledger and the baseline may list the same payload. The ledger comes first, so its entry is kept.
        published = {(entry.number, entry.proto): entry for entry in reversed(context.published)}
        envelope = context.schema.messages.get(table.envelope.message)
        members = [field for field in envelope.fields if field.oneof == table.envelope.oneof] if envelope else []
        # A number or a text in the oneof is no row. It is in use as long as another team's envelope declares it.
        without_row = {field.number for field in members if field.type_name not in context.schema.messages}
        for entry in published.values():
            if entry.number in table.numbers or entry.number in without_row:
                continue
            message = (
                f"field {entry.number} was published as {entry.name!r} ({entry.proto}), but is missing in {table.file}"
            )
            entry_text = f"{{number: {entry.number}, name: {entry.name}, proto: {entry.proto}}}"
            moved = [row for row in table.members if row.proto == entry.proto]
            unpublished = [row.name for row in moved if (row.number, row.proto) not in published]
            if entry.proto == "bytes":
                back = f"put `signing: {{number: {entry.number}}}` back"
            elif unpublished:
                back = f"give {unpublished[0]!r} the number {entry.number} again"
            else:
                back = "put the row back"
            rename = f", and rename {entry.name!r}" if entry.name in unpublished else ""
            help = f"{back}, or add to `retired`: - {entry_text}{rename}"
            of_ledger = entry in context.ledger.entries
            span = entry.span if of_ledger else Span(table.file)  # an earlier state cannot be edited
            also = [] if of_ledger else [(entry.span, "published here")]
            if of_ledger and moved:
                help += f"; if no program has used {entry.number} yet, restore the earlier {NAME}"
            rests_on = [row.at("number") for row in moved]
            yield cls.at(span, message, help, also, type=table.envelope.message, number=entry.number, rests_on=rests_on)


class FieldNumberOutOfRange(LintRule, id="ENV104"):
    """A field number is one that protobuf keeps for itself.

    The numbers from 19000 to 19999 belong to protobuf's implementation. protoc rejects them.

    Bad::

        - {number: 19000, name: imu_info, proto: SensorBoardIMUInfo, topic: imu_data, direction: hardware_to_ros}

    Good::

        - {number: 22, name: imu_info, proto: SensorBoardIMUInfo, topic: imu_data, direction: hardware_to_ros}
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each row or signature with a number from 19000 to 19999."""
        first, last = IMPLEMENTATION_NUMBERS.start, IMPLEMENTATION_NUMBERS.stop - 1
        for row in context.table.numbered:
            if row.number in IMPLEMENTATION_NUMBERS:
                message = f"field {row.number} is reserved for protobuf itself ({first} to {last})"
                yield cls.of_row(context.table, row, "number", message, f"choose a number below {first}")


class BurnedNumberTaken(LintRule, id="ENV110"):
    """A payload takes a burned number: a number that several other payloads had in the past.

    Boards and recordings disagree on the meaning of such a number. The user accepted its past with the command
    `roverlink lint --history --accept`, which lists it as burned in the ledger: mapping.lock, or accepted-numbers.lock
    in a folder of .proto files without a table. A payload that had the number then keeps it. If no payload had it, no
    payload may use it again. An earlier payload may not come back, either; accept the number again if it does no harm.

    Bad::

        # mapping.lock says under `burned`: `PBEnvelope 18: Foo foo | Bar bar`
        - {number: 18, name: baz, proto: Baz, topic: baz, direction: hardware_to_ros}

    Good::

        - {number: 22, name: baz, proto: Baz, topic: baz, direction: hardware_to_ros}
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each row or signature with a burned number that it must not have."""
        envelope = context.table.envelope.message
        for row in context.table.numbered:
            burned = context.ledger.must_not_be(envelope, row.number, PastUse(row.proto, row.name))
            # The type says what a payload means, so the payload may have another name.
            if burned and not (burned.now and burned.now.type == row.proto):
                help = f"give {row.name!r} the number {context.next_number()}, which was never used"
                message = (
                    f"field {row.number} was used for {burned.description} in the past, and must never be used again"
                )
                yield cls.of_row(context.table, row, "number", message, help)


class NumberSkipped(LintRule, id="TAB106", severity=Severity.HINT):
    """A new row skips numbers.

    A skipped number looks as if it had been used once, and every reader has to check that. Large numbers also cost
    bytes: a number above 15 takes one more byte in every datagram.

    Bad::

        # the largest number that was ever used is 21
        messages:
          - {number: 30, name: wind, proto: SensorBoardWind, topic: wind, direction: hardware_to_ros}

    Good::

        messages:
          - {number: 22, name: wind, proto: SensorBoardWind, topic: wind, direction: hardware_to_ros}
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each new row with a larger number than the next free one.

        If nothing has been published yet, nothing is reported.
        """
        published = {entry.number for entry in context.published}
        if not published:
            return
        table = context.table
        # A payload whose published number is missing in the table is not new: ENV103 reports it.
        moved = {entry.proto for entry in context.published if entry.number not in table.numbers}
        new = {
            row.number: row for row in reversed(table.members) if row.number not in published and row.proto not in moved
        }
        # Only numbers above all old ones are certain to have never been used.
        old = published | (table.numbers - new.keys())
        smallest = max(old)
        for number in sorted(number for number in new if number > max(old)):
            smallest = context.free_number(smallest + 1, besides=new.keys())
            if number > smallest:
                row = new[number]
                message = f"field {number} skips numbers that were never used; the next number is {smallest}"
                help = f"give {row.name!r} the number {smallest}, and restore {NAME} if it has {number} already"
                rests_on = [row.at("number"), row.at("proto")]
                yield cls.of_row(table, row, "number", message, help, rests_on=rests_on)
