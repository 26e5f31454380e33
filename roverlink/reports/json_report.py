"""Findings of `roverlink lint` as JSON: a list with one object for each finding."""

from __future__ import annotations

import json
from typing import Any

from roverlink.generator.diagnostics import Diagnostic, Span, Use
from roverlink.generator.lint.project import Linted


def write(linted: Linted) -> None:
    """Print the findings as a JSON list on standard output."""
    print(json.dumps([_finding(finding, linted) for finding in linted.findings], indent=2))


def _finding(finding: Diagnostic, linted: Linted) -> dict[str, Any]:
    return {
        "id": finding.rule.id,
        "name": finding.rule.name,
        "severity": finding.severity.value,
        "message_type": finding.type or None,
        "number": finding.number,
        **_place(finding.span),
        "message": finding.message,
        "help": finding.help or None,
        "history": [_use(use) for use in finding.uses],
        "also": [{**_place(span), "text": text, "commit": _commit(span, linted)} for span, text in finding.also],
    }


def _use(use: Use) -> dict[str, Any]:
    """Return the JSON values for one meaning (type and name) that a number had in git's history.

    ``last_commit`` is the commit that removed this meaning; None if a branch still has it. The id of a commit is None
    for a change that is not committed yet.
    """
    went = use.went
    last = {"last_commit": went.id or None, "last_date": went.date, "last_subject": went.subject} if went else {}
    return {
        "type": use.type,
        "name": use.name,
        "first_commit": use.came.id or None,
        "first_date": use.came.date,
        "first_subject": use.came.subject,
        "last_commit": None,
        **last,
    }


def _place(span: Span) -> dict[str, Any]:
    return {"path": span.file, "line": span.line or None, "column": span.column or None}


def _commit(span: Span, linted: Linted) -> dict[str, str] | None:
    commit = linted.commit_of(span)
    return {"id": commit.id, "date": commit.date, "subject": commit.subject} if commit else None
