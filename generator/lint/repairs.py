"""Repairs: changes that give a number back to the meaning that it had before a mistake.

A comparison with the mistake finds another meaning, and so does the history. To undo the repair would bring the mistake
back, so these diagnostics are hints.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Severity
from roverlink.generator.lint.accepted_past import has_meaning, meaning_of
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.history import Kind, Relation
from roverlink.generator.lint.history_diagnostics import began, stands_today
from roverlink.generator.lock import PastUse

_OF_MEANINGS = frozenset({"ENV102", "WIR101", "WIR103", "WIR110", "WIR114", "WIR115", "WIR116", "HIS101", "HIS105"})


def repairs_as_hints(found: list[Diagnostic], context: Context) -> Iterator[Diagnostic]:
    """Yield the diagnostics; those about a number that has an earlier meaning again as hints.

    The ledger of the state or of the baseline shows this, or git's history if the user requested it.
    """
    for finding in found:
        if finding.number is None or finding.known or finding.rule.id not in _OF_MEANINGS:
            yield finding
            continue
        today = _meaning_today(context, finding.type, finding.number)
        if today and _is_restored(context, finding.type, finding.number, today):
            finding = dataclasses.replace(
                finding,
                severity=Severity.HINT,
                message=f"{finding.message}; with {today.name!r}, it has an earlier meaning back",
                help=f"keep {today.name!r}; make sure that no program with the meaning in between is still in use",
            )
        yield finding


def _meaning_today(context: Context, owner: str, number: int) -> PastUse | None:
    if context.table.proto.root and owner == context.table.envelope.message:
        rows = (row for row in context.table.rows if row.number == number)
        return next((PastUse(row.proto, row.name) for row in rows), None)
    return stands_today(context, owner, number)


def _is_restored(context: Context, owner: str, number: int, today: PastUse) -> bool:
    ledgers = [context.ledger, *([context.base.ledger] if context.base else [])]
    lost = (
        use
        for ledger in ledgers
        for use in (
            *(meaning_of(field) for field in ledger.gone_fields.get(owner, ()) if field.number == number),
            *(meaning_of(value) for value in ledger.gone_values.get(owner, ()) if value.number == number),
            *(PastUse(entry.proto, entry.name) for entry in ledger.entries if entry.gone and entry.number == number),
        )
    )
    return today in lost or _is_restored_in_history(context, owner, number, today)


def _is_restored_in_history(context: Context, owner: str, number: int, today: PastUse) -> bool:
    """Return True if a number lost the meaning of today to another one, and got it back.

    False if today's meaning itself took the place of an earlier one since the baseline.
    """
    past = context.past
    if past is None or not past.of_numbers:
        return False
    restored = False
    for type in past.history.types_by_name.get(owner, ()):
        for reuse in past.history.reuses_of(type.id):
            if reuse.number != number or reuse.kind is Kind.RENAMED or reuse.earlier is reuse.later:
                continue
            if has_meaning(past.history, type, reuse.later, today) and not past.is_known(*began(reuse)):
                return False
            put_back = reuse.relation is Relation.SUCCESSION and len(reuse.earlier.intervals) > 1
            restored |= put_back and has_meaning(past.history, type, reuse.earlier, today)
    return restored
