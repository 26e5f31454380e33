"""Acceptance of the past: numbers that had several meanings in git's history are recorded in the ledger as burned.

A burned number must never be used again. Later runs of the lint do not report it.
"""

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

_HISTORY_RULES = ("HIS101", "HIS103")


def accept(table_path: Path, found: Linted) -> tuple[list[Change], int]:
    """Return the changes of files that record the numbers found in history as burned, and how many numbers these are.

    ``found`` is the result of the lint. Raises `DiagnosticsError` if there is no table, or if it does not compile.
    """
    past = found.context.past
    if not found.context.table.proto.root or past is None or not past.of_numbers:
        message = "--accept needs --history and a project with a mapping.yaml, because it writes to the ledger"
        raise DiagnosticsError([NOTHING_TO_ACCEPT_INTO.at(Span(str(table_path)), message)])
    of_history = [finding for finding in found.findings if finding.rule.id in _HISTORY_RULES]
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
    """Return the burned number with its new and its known meanings; ``known`` is None if it was not burned before."""
    if known is None:
        return one
    return dataclasses.replace(one, uses=tuple(dict.fromkeys((*known.uses, *one.uses))))
