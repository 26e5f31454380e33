"""Engine of the lint: runs every rule, and then lowers severities as the table says in its ``lint`` sections."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Iterator, Sequence

from roverlink.generator.diagnostics import Diagnostic, Severity, independent
from roverlink.generator.lint.baseline import without_known
from roverlink.generator.lint.buf import unstated
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.repairs import repairs_as_hints
from roverlink.generator.lint.rules import lint_rules
from roverlink.generator.protos.proto_rules import ProtoDoesNotCompile
from roverlink.generator.table import Lowered

_OF_THE_ENVELOPE = "ENV"
_OF_CHANGES = "WIR"
_OF_HISTORY = "HIS"
_REUSED = "ENV102"
_NEVER_SETTLED = ("ENV101", "WIR101", "WIR103")
_OF_CLASHES = ("NAM101", "NAM103")


def lint(context: Context, of_buf: Sequence[Diagnostic] = ()) -> list[Diagnostic]:
    """Run all rules, and return their diagnostics, the faults of the state, and the diagnostics of buf.

    A fault that the baseline has already is a hint, and so is one that the state repairs. The table can lower the
    severity of the others.

    ``of_buf`` are the diagnostics of the program buf. Those that repeat a diagnostic of our own rules are dropped.
    """
    found = _found(context)
    if context.base is not None:
        found = list(without_known(found, context.base, _found(context.base.compared_with(context.base))))
    remaining = [*_without_repetitions(found, context.table.envelope.message), *unstated(of_buf, found)]
    counted = (_as_the_table_says(finding, context) for finding in repairs_as_hints(remaining, context))
    return independent(_each_number_once(finding for finding in counted if finding is not None))


def _found(context: Context) -> list[Diagnostic]:
    """Return the faults of a state, and the diagnostics of all rules about it."""
    # Two rules may find the same fault, and so may comparisons with two earlier states. A dict removes repetitions and
    # keeps the order of the rules.
    of_rules = (finding for rule in lint_rules().values() for finding in rule.check(context))
    return list(dict.fromkeys([*context.faults, *of_rules]))


def _without_repetitions(found: Iterable[Diagnostic], envelope: str) -> Iterator[Diagnostic]:
    """Yield the diagnostics without those that report a field of the envelope, or a clash, a second time.

    If a rule about the envelope (``ENV...``) reports a number, the diagnostics of the rules about changes (``WIR...``)
    for the same number are dropped. protoc's error about two equal names is dropped if a rule reports them.
    ``envelope`` is the full name of the envelope's message.
    """
    found = list(found)
    payloads = {
        finding.number for finding in found if finding.type == envelope and finding.rule.id.startswith(_OF_THE_ENVELOPE)
    }
    reported = {*payloads, None} if payloads else payloads  # None stands for a range of reserved numbers
    clashes = [finding for finding in found if finding.rule.id in _OF_CLASHES]
    places = {span for finding in clashes for span in (finding.span, *(span for span, _ in finding.also))}
    lines = {(span.file, span.line) for span in places}
    for finding in found:
        of_change = finding.type == envelope and finding.rule.id.startswith(_OF_CHANGES)
        of_clash = finding.rule is ProtoDoesNotCompile and (finding.span.file, finding.span.line) in lines
        if not (of_change and finding.number in reported) and not of_clash:
            yield finding


def _each_number_once(found: Iterable[Diagnostic]) -> Iterator[Diagnostic]:
    """Yield the diagnostics without those of a reuse that both the history and a comparison report.

    The one from the history (``HIS...``) stays, because it has a way to accept the number. That of the comparison stays
    if accepting the past does not settle it.
    """
    found = list(found)
    errors = [finding for finding in found if finding.severity is Severity.ERROR]
    firm = {(finding.type, finding.number) for finding in errors if finding.rule.id in _NEVER_SETTLED}
    reused = {(finding.type, finding.number) for finding in errors if finding.rule.id.startswith(_OF_HISTORY)}
    for finding in found:
        about, id = (finding.type, finding.number), finding.rule.id
        dropped = firm if id.startswith(_OF_HISTORY) else reused - firm
        compared = id.startswith((_OF_HISTORY, _OF_CHANGES)) or id == _REUSED
        if not compared or about not in dropped:
            yield finding


def _as_the_table_says(finding: Diagnostic, context: Context) -> Diagnostic | None:
    """Return a diagnostic with the severity that the table sets; None if the table turns it off.

    A folder without a table has a ledger of what the user has accepted. A fatal diagnostic stays as it is.
    """
    if finding.severity is Severity.FATAL:
        return finding
    if any(settled.covers(finding) for settled in context.ledger.settled):
        return finding.as_known()
    severity: Severity = finding.severity
    for lowered in _lowerings(finding, context):
        if lowered.severity == "off":
            return None
        severity = max([severity, Severity(lowered.severity)], key=lambda level: level.rank)
    return dataclasses.replace(finding, severity=severity)


def _lowerings(finding: Diagnostic, context: Context) -> Iterator[Lowered]:
    table, id = context.table, finding.rule.id
    if finding in context.faults:
        return  # a table lowers rules of the lint only (TAB108)
    yield from (lowered for lowered in table.lint if lowered.rule == id)
    for row in table.rows:
        of_row = [lowered for lowered in row.lint if lowered.rule == id]
        if of_row and _is_about(finding, row.number, row.proto, context):
            yield from of_row


def _is_about(finding: Diagnostic, number: int, proto: str, context: Context) -> bool:
    """Return True if a diagnostic is about the row with the envelope number ``number`` and the message ``proto``.

    A diagnostic about the envelope, or about no type, must have the row's number. Any other diagnostic must be about
    the row's message, or about a message or enum inside it.
    """
    if finding.type in ("", context.table.envelope.message):
        return finding.number == number
    messages, enums = context.schema.reachable(proto)
    return finding.type == proto or finding.type in messages or finding.type in enums
