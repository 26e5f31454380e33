"""Lower severities for the lint rules that the adopted .proto files break: their diagnostics become hints.

So most old mistakes do not fail the lint of an adopted project.
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import groupby

from roverlink.generator.adopt.draft import Draft, DraftRow
from roverlink.generator.diagnostics import Diagnostic, Severity
from roverlink.generator.lint.rules import lint_rules
from roverlink.generator.protos.schema import Schema

_MUST_HOLD = frozenset({"ENV101", "ENV104", "ROS101", "TAB101", "TAB102", "TAB103", "TAB104"})
"""Ids of the rules that keep their severity, because the generated code would be wrong if they are broken."""
_MANY_ROWS = 3


def lower(draft: Draft, findings: Iterable[Diagnostic], schema: Schema) -> None:
    """Set in the draft the severity ``hint``, with a reason, for each rule that has raised an error or a warning.

    If the diagnostics of a rule are about at most three rows, the setting applies to these rows; otherwise to the whole
    table. Some rules keep their severity, because the generated code would be wrong.
    """
    grave = [finding for finding in findings if finding.severity.rank <= Severity.WARNING.rank]
    may_count_less = lint_rules().keys() - _MUST_HOLD
    ids = sorted(
        (finding for finding in grave if finding.rule.id in may_count_less), key=lambda finding: finding.rule.id
    )
    for rule, found in groupby(ids, key=lambda finding: finding.rule.id):
        listed = list(found)
        about = [_rows_about(finding, draft, schema) for finding in listed]
        rows = {row.number: row for of_one in about for row in of_one}
        if all(about) and len(rows) <= _MANY_ROWS:
            for row in rows.values():
                row.lint[rule] = "found when the tree was taken over"
        else:
            times = "once" if len(listed) == 1 else f"{len(listed)} times"
            draft.lint[rule] = f"found {times} when the tree was taken over"


def _rows_about(finding: Diagnostic, draft: Draft, schema: Schema) -> list[DraftRow]:
    """Return the rows that a diagnostic is about. The `lint` settings of these rows apply to it."""
    if finding.type in ("", draft.message):
        return [row for row in draft.rows if row.number == finding.number]
    return [row for row in draft.rows if any(finding.type in kind for kind in schema.reachable(row.proto))]
