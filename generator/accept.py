"""Implementation of `roverlink lint --accept`: records reused numbers as burned in the ledger, and accepted rules.

A number is reused if git's history gives it several meanings, for example two different fields. The user states that
these meanings are known: that they are only names of one meaning, or that no machine confuses them. After that, the
lint reports the number again only if it gets another meaning. The ledger is mapping.lock, or in a folder of .proto
files without a table the file accepted-numbers.lock. There the user can also accept a rule, or one of its diagnostics;
a table has settings under `lint` for this.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from roverlink.generator import lock
from roverlink.generator.diagnostics import Diagnostic, DiagnosticsError, Severity, Span
from roverlink.generator.emit.writer import Change, compare
from roverlink.generator.lint.accepted_past import accepted, meanings, number_to_accept
from roverlink.generator.lint.context import Context, Past
from roverlink.generator.lint.history import Kind, Reuse, TracedType
from roverlink.generator.lint.history_diagnostics import reuses_by_number, stands_today
from roverlink.generator.lint.input_rules import DEEPEN
from roverlink.generator.lint.project import Linted
from roverlink.generator.lock import Burned, Settled
from roverlink.generator.lock.ledger_rules import LEDGER_RULES
from roverlink.generator.pipeline import recompile
from roverlink.generator.protos.proto_rules import ProtoDoesNotCompile
from roverlink.generator.table.edit_rules import AcceptWithoutHistory, NoFindingToAccept

_HISTORY_RULES = ("HIS101", "HIS103", "HIS105")

Number = tuple[str, int]
"""A number of a message or enum, which is given by its full name."""


def accept(
    table_path: Path | None,
    found: Linted,
    wanted: Sequence[Number] = (),
    rules: Sequence[Settled] = (),
    reason: str = "",
) -> tuple[list[Change], int]:
    """Return the file changes that record reused numbers as burned, and rules as accepted, and the count of numbers.

    ``table_path`` is None for a folder without a table. ``found`` is the result of a lint, with history if numbers are
    to be accepted. ``wanted`` are the numbers to accept, and ``rules`` the rules: all numbers that the lint reports if
    both are empty. A number with an empty name is a number of the envelope. ``reason`` is stored with them. Nothing is
    written. Raises `DiagnosticsError` if the lint had no history, if it reports nothing about a number or a rule, if
    the ledger is damaged, or if mapping.yaml does not compile.
    """
    context = found.context
    # Writing a ledger that was read only in part would lose the rest of it.
    if damaged := [finding for finding in found.findings if finding.rule in LEDGER_RULES]:
        raise DiagnosticsError(damaged)
    if refused := list(_not_settled(rules, found, table_path)):
        raise DiagnosticsError(refused)
    chosen = _numbers(found, wanted) if wanted or not rules else set[Number]()
    published = context.ledger.with_burned(_burned(context, chosen, reason)).with_settled(rules, reason)
    if table_path is not None:
        return recompile(table_path, published).changes(table_path.resolve().parent), len(chosen)
    if unknown := list(_not_compiled(found, chosen)):
        raise DiagnosticsError(unknown)
    files = {lock.ACCEPTED_NAME: lock.render_accepted(published)} if published.burned or published.settled else {}
    return compare(found.folder, files, {}, own=(lock.ACCEPTED_NAME,)), len(chosen)


def _not_settled(rules: Iterable[Settled], found: Linted, table_path: Path | None) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each rule that cannot be accepted: it has no finding, or the project has a table."""
    for settled in rules:
        about = f"{settled.rule} about {settled.subject!r}" if settled.subject else settled.rule
        if table_path is not None:
            help = f"write under `lint` in {table_path.name}: {settled.rule}: {{severity: hint, reason: ...}}"
            yield NoFindingToAccept.at(Span("--accept"), f"a project with a table lowers {about} in the table", help)
        elif not any(settled.covers(one) and one.severity is not Severity.FATAL for one in found.findings):
            help = "name the rule of a finding that is not fatal, alone or as in NAM103:pk.Kind or PRO101:imu.proto"
            yield NoFindingToAccept.at(Span("--accept"), f"the lint has no finding of {about} to accept", help)


def _numbers(found: Linted, wanted: Sequence[Number]) -> set[Number]:
    """Return the numbers to accept: those of ``wanted``, or all that the lint reports."""
    context, past = found.context, found.context.past
    if past is None or not past.of_numbers:
        help = "add --history to the command"
        raise DiagnosticsError([AcceptWithoutHistory.at(Span("--accept"), "--accept needs --history", help)])
    shown = {(finding.type, finding.number) for finding in found.findings if finding.rule.id in _HISTORY_RULES}
    reported = {(type.name, number) for type, number, _ in _reuses(context) if (type.name, number) in shown}
    return _chosen(context, past, wanted, reported) if wanted else reported


def _chosen(context: Context, past: Past, wanted: Iterable[Number], reported: Iterable[Number]) -> set[Number]:
    """Return the full names and numbers of ``wanted``. Each must be reported, or accepted already."""
    envelope = context.table.envelope.message
    chosen = {(owner or envelope, number) for owner, number in wanted}
    if any(not owner for owner, _ in chosen):
        message = "a number without a message is a number of the envelope, and the envelope is not named"
        help = "name the envelope with --message, or write the message before the number: --accept rover.ImuInfo:3"
        raise DiagnosticsError([NoFindingToAccept.at(Span("--accept"), message, help)])
    known = {*reported, *((entry.owner, entry.number) for entry in context.ledger.burned)}
    if missing := sorted(chosen - known):
        ready = ", ".join(number_to_accept(context, *number) for number in sorted(reported))
        help = f"--accept takes the reported numbers: {ready}" if ready else "leave out --accept: nothing is reported"
        if past.history.shallow:
            help = f"this is a shallow clone, which lacks earlier commits: get them with {DEEPEN}; {help}"
        raise DiagnosticsError(
            [
                NoFindingToAccept.at(Span("--accept"), f"--history reports nothing about number {n} of {owner!r}", help)
                for owner, n in missing
            ]
        )
    return chosen


def _burned(context: Context, chosen: set[Number], reason: str) -> Iterable[Burned]:
    """Yield the chosen numbers as burned, with their meanings, those that were accepted before included."""
    for known in context.ledger.burned:
        if (known.owner, known.number) in chosen:
            yield _today(context, dataclasses.replace(known, reason=reason or known.reason))
    for type, number, reuses in _reuses(context):
        if context.past and (type.name, number) in chosen:
            one = Burned(type.name, number, tuple(meanings(context.past.history, type, reuses)), None, reason)
            for earlier in accepted(context, type, number):
                one = one.joined(earlier)
            yield _today(context, one)


def _reuses(context: Context) -> Iterator[tuple[TracedType, int, list[Reuse]]]:
    """Yield each number with its changes of meaning, without those that are the business of a branch."""
    for type, number, reuses in reuses_by_number(context, frozenset(Kind) - {Kind.RENAMED}):
        # What a branch does with the number is not accepted together with the past, but only if it is all that is
        # reported.
        here = [reuse for reuse in reuses if not reuse.elsewhere] or [reuse for reuse in reuses if not reuse.unmerged]
        if here:
            yield type, number, here


def _today(context: Context, burned: Burned) -> Burned:
    """Return a burned number with the meaning that it has today, and may keep."""
    now = stands_today(context, burned.owner, burned.number)
    # The history spells a map and a group in another way than today's schema.
    uses = burned.uses if now is None else tuple(dict.fromkeys((*burned.uses, now)))
    return dataclasses.replace(burned, uses=uses, now=now)


def _not_compiled(found: Linted, chosen: Iterable[Number]) -> Iterable[Diagnostic]:
    """Yield the errors of protoc if they hide what a chosen number means today."""
    context = found.context
    compiled = {*context.schema.messages, *context.schema.enums}
    declared = {message.full_name for file in context.files.values() for message in file.messages}
    declared |= {enum.full_name for file in context.files.values() for enum in file.enums}
    if any(owner in declared - compiled for owner, _ in chosen):
        yield from (
            finding
            for finding in found.findings
            if finding.rule is ProtoDoesNotCompile and finding.severity is Severity.ERROR
        )
