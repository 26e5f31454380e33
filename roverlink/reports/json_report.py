"""Findings as JSON: a list with one object for each finding."""

from __future__ import annotations

import json
from typing import Any

from roverlink.generator.diagnostics import Diagnostic, Span, Use
from roverlink.generator.git import Commit
from roverlink.reports.reported import Reported


def write(reported: Reported) -> None:
    """Print the findings as a JSON list on standard output."""
    print(json.dumps([_finding(finding, reported) for finding in reported.findings], indent=2))


def _finding(finding: Diagnostic, reported: Reported) -> dict[str, Any]:
    return {
        "id": finding.rule.id,
        "name": finding.rule.name,
        "severity": finding.severity.value,
        "known": finding.known,
        "message_type": finding.type or None,
        "number": finding.number,
        **_place(finding.span),
        "message": finding.message,
        "help": finding.help or None,
        "history": [_use(use) for use in finding.uses],
        "also": [{**_place(span), "text": text, "commit": _commit(span, reported)} for span, text in finding.also],
    }


def _use(use: Use) -> dict[str, Any]:
    """Return the JSON values for one meaning (type and name) that a number had in git's history.

    ``path`` and ``line`` are the place of the declaration at the first commit. ``last_commit`` is the commit that
    removed this meaning; None if a branch still has it. The id of a commit is None for a change that is not committed
    yet.
    """
    return {
        "type": use.type,
        "name": use.name,
        "declaration": "\n".join(filter(None, use.declaration)),
        "path": use.place.file,
        "line": use.place.line,
        **_of_commit("first", use.came),
        "last_commit": None,
        **(_of_commit("last", use.went) if use.went else {}),
        "today": use.today or None,
        "doubt": use.doubt or None,
    }


def _of_commit(prefix: str, commit: Commit) -> dict[str, str | None]:
    about = {"commit": commit.id or None, "date": commit.date, "author": commit.author, "subject": commit.subject}
    return {f"{prefix}_{key}": value for key, value in about.items()}


def _place(span: Span) -> dict[str, Any]:
    return {"path": span.file, "line": span.line or None, "column": span.column or None}


def _commit(span: Span, reported: Reported) -> dict[str, str] | None:
    commit = reported.sources.commit_of(span)
    return {"id": commit.id, "date": commit.date, "subject": commit.subject} if commit else None
