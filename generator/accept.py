"""Accepting the past: what history found goes into the ledger as burned numbers, and is not found again."""

from __future__ import annotations

import dataclasses
from pathlib import Path

from roverlink.generator.diagnostics import Diagnostic, DiagnosticsError, Span
from roverlink.generator.emit.writer import Change, compare
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.history_diagnostics import stands_today
from roverlink.generator.lint.project import Linted
from roverlink.generator.lock import Burned
from roverlink.generator.pipeline import recompile
from roverlink.generator.table.edit_rules import NOTHING_TO_ACCEPT_INTO

_OF_HISTORY = ("HIS101", "HIS103")


def accept(table_path: Path, found: Linted) -> tuple[list[Change], int]:
    """The changes that burn what history found in a table's project, and how many numbers that are.

    Raises `DiagnosticsError` where there is no table, and where it does not compile.
    """
    past = found.context.past
    if not found.context.table.proto.root or past is None or not past.of_numbers:
        message = "there is no ledger: accepting takes --history in a project with a mapping.yaml"
        raise DiagnosticsError([NOTHING_TO_ACCEPT_INTO.at(Span(str(table_path)), message)])
    of_history = [finding for finding in found.findings if finding.rule.id in _OF_HISTORY]
    burned = {(one.owner, one.number): one for one in found.context.ledger.burned}
    for finding in of_history:
        one = _burned(finding, found.context)
        burned[one.owner, one.number] = _joined(burned.get((one.owner, one.number)), one)
    published = dataclasses.replace(found.context.ledger, burned=tuple(one for _, one in sorted(burned.items())))
    compiled = recompile(table_path, published)
    return compare(table_path.resolve().parent, compiled.files, compiled.folders), len(of_history)


def _burned(finding: Diagnostic, context: Context) -> Burned:
    owner, number = finding.type, finding.number or 0
    return Burned(
        owner, number, tuple((use.type, use.name) for use in finding.uses), stands_today(context, owner, number)
    )


def _joined(known: Burned | None, one: Burned) -> Burned:
    """What was accepted before, and what is now."""
    if known is None:
        return one
    return dataclasses.replace(one, uses=tuple(dict.fromkeys((*known.uses, *one.uses))))
