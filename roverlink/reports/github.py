"""Findings as workflow commands of GitHub Actions, which GitHub shows in a pull request.

The syntax is in GitHub's documentation, "Workflow commands for GitHub Actions".
"""

from __future__ import annotations

from roverlink.generator.diagnostics import Diagnostic, Severity, Span
from roverlink.reports.reported import Reported
from roverlink.reports.repository_places import main_place, whole_text

_COMMANDS = {Severity.FATAL: "error", Severity.ERROR: "error", Severity.WARNING: "warning", Severity.HINT: "notice"}


def write(reported: Reported) -> None:
    """Print one workflow command of GitHub Actions for each finding that is shown."""
    for finding in reported.shown:
        print(_command(finding, reported))
    if reported.left_out:
        print(reported.left_out)


def _command(finding: Diagnostic, reported: Reported) -> str:
    # Without a file, GitHub shows the command on the page of the workflow's run.
    span, rule = main_place(finding, reported) or Span(""), finding.rule
    properties = {"file": span.name, "line": span.line, "col": span.column, "title": f"{rule.id} {rule.name}"}
    shown = ",".join(f"{name}={_escaped(str(value), ':,')}" for name, value in properties.items() if value)
    return f"::{_COMMANDS[finding.severity]} {shown}::{_escaped(whole_text(finding, reported, with_related=True))}"


def _escaped(text: str, more: str = "") -> str:
    """Percent-encode the characters that would end a workflow command, and the characters in ``more``.

    ``more`` holds the characters that would end a property of the command.
    """
    for character in f"%\r\n{more}":
        text = text.replace(character, f"%{ord(character):02X}")
    return text
