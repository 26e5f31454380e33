"""Implementation of `roverlink lint --history --accept`: records reused numbers as burned in the ledger, mapping.lock.

A number is reused if git's history gives it several meanings, for example two different fields. After it is burned, it
must never get another meaning, and later runs of the lint do not report its past meanings again.
"""

from __future__ import annotations

import dataclasses
from pathlib import Path

from roverlink.generator.diagnostics import Diagnostic, DiagnosticsError, Span
from roverlink.generator.emit.writer import Change
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.history_diagnostics import stands_today
from roverlink.generator.lint.project import Linted
from roverlink.generator.lock import Burned
from roverlink.generator.pipeline import recompile
from roverlink.generator.table.edit_rules import NOTHING_TO_ACCEPT_INTO

_HISTORY_RULES = ("HIS101", "HIS103", "HIS105")


def accept(table_path: Path, found: Linted) -> tuple[list[Change], int]:
    """Return the file changes that record reused numbers as burned, and the count of these numbers.

    ``found`` is the result of a lint with history; its diagnostics name the reused numbers. Nothing is written. Raises
    `DiagnosticsError` if the project has no mapping.yaml or no history, or if mapping.yaml does not compile.
    """
    past = found.context.past
    if not found.context.table.proto.root or past is None or not past.of_numbers:
        message = "--accept needs --history and a project with a mapping.yaml, because it writes to the ledger"
        help = "run `roverlink lint --history --accept` in the folder of mapping.yaml"
        raise DiagnosticsError([NOTHING_TO_ACCEPT_INTO.at(Span(str(table_path)), message, help)])
    of_history = [finding for finding in found.findings if finding.rule.id in _HISTORY_RULES]
    burned = {(one.owner, one.number): one for one in found.context.ledger.burned}
    for finding in of_history:
        one = _burned(finding, found.context)
        burned[one.owner, one.number] = _joined(burned.get((one.owner, one.number)), one)
    published = dataclasses.replace(found.context.ledger, burned=tuple(one for _, one in sorted(burned.items())))
    compiled = recompile(table_path, published)
    return compiled.changes(table_path.resolve().parent), len(of_history)


def _burned(finding: Diagnostic, context: Context) -> Burned:
    owner, number = finding.type, finding.number or 0
    # The contents that a message had one after the other have one name.
    uses = tuple(dict.fromkeys((use.type, use.name) for use in finding.uses))
    return Burned(owner, number, uses, stands_today(context, owner, number))


def _joined(known: Burned | None, one: Burned) -> Burned:
    """Return the burned number ``one`` with the meanings of ``known`` added.

    ``known`` is the ledger's earlier record of the same number; None if the number was not burned before.
    """
    if known is None:
        return one
    return dataclasses.replace(one, uses=tuple(dict.fromkeys((*known.uses, *one.uses))))
