"""Findings as SARIF 2.1.0 (OASIS), a JSON format for services that show findings beside code.

GitHub's code scanning adds its own demands ("SARIF support for code scanning" in its documentation):

- It refuses the whole document if a result has no file. So a finding about no file, such as a wrong folder on the
  command line, is a notification about the run and not a result.
- A region needs a line; paths start at the top of the repository.
- It recognizes a finding of an earlier run by the fingerprint ``primaryLocationLineHash``, and by no other one. Without
  it, the upload would use the text of the line.
"""

from __future__ import annotations

import json
import re
from collections import Counter
from hashlib import sha256
from typing import Any
from urllib.parse import quote

from roverlink.generator.diagnostics import Diagnostic, Rule, Severity, Span
from roverlink.reports.reported import Reported
from roverlink.reports.repository_places import main_place, related_places, whole_text

_LEVELS = {Severity.FATAL: "error", Severity.ERROR: "error", Severity.WARNING: "warning", Severity.HINT: "note"}
_SCHEMA = "https://json.schemastore.org/sarif-2.1.0.json"
_LINE_NUMBERS = re.compile(r"(?<=[\w)]):\d+(:\d+)?")


def write(reported: Reported) -> None:
    """Print the findings as a SARIF document on standard output."""
    rules = {id: _rule(rule) for id, rule in reported.rules.items()}
    rules |= {finding.rule.id: _rule(finding.rule) for finding in reported.findings}
    driver = {"name": "roverlink", "rules": [rules[id] for id in sorted(rules)]}
    results, notifications = list[dict[str, Any]](), list[dict[str, Any]]()
    seen = Counter[str]()
    for finding in reported.findings:
        if place := main_place(finding, reported):
            results.append(_result(finding, place, reported, seen))
        else:
            about = {"descriptor": {"id": finding.rule.id}, "level": _LEVELS[finding.severity]}
            notifications.append({**about, "message": {"text": whole_text(finding, reported, with_related=True)}})
    successful = all(finding.severity is not Severity.FATAL for finding in reported.findings)
    invocation = {"executionSuccessful": successful, "toolExecutionNotifications": notifications}
    run = {"tool": {"driver": driver}, "invocations": [invocation], "results": results}
    print(json.dumps({"$schema": _SCHEMA, "version": "2.1.0", "runs": [run]}, indent=2))


def _rule(rule: type[Rule]) -> dict[str, Any]:
    return {
        "id": rule.id,
        "name": rule.name,
        "shortDescription": {"text": rule.summary},
        "fullDescription": {"text": rule.documentation.partition("\nBad::")[0].strip()},
        "help": {"text": rule.explanation},
        "defaultConfiguration": {"level": _LEVELS[rule.severity]},
    }


def _result(finding: Diagnostic, place: Span, reported: Reported, seen: Counter[str]) -> dict[str, Any]:
    fingerprint = _fingerprint(finding, place)
    seen[fingerprint] += 1
    result: dict[str, Any] = {
        "ruleId": finding.rule.id,
        "level": _LEVELS[finding.severity],
        "message": {"text": whole_text(finding, reported, with_related=False)},
        "locations": [_location(place)],
        "partialFingerprints": {"primaryLocationLineHash": f"{fingerprint}:{seen[fingerprint]}"},
    }
    related = [{**_location(span), "message": {"text": what}} for span, what in related_places(finding, reported)]
    if related:
        result["relatedLocations"] = related
    return result


def _fingerprint(finding: Diagnostic, place: Span) -> str:
    """Return a text that stays the same if lines move, and if other findings or unrelated commits are added."""
    parts = [finding.rule.id, finding.type, str(finding.number)]
    parts += [text for use in finding.uses for text in (use.type, use.name, *use.declaration)]
    if finding.number is None:  # only the message tells it from others
        parts += [place.file, _LINE_NUMBERS.sub("", finding.message)]
    return sha256("\0".join(parts).encode()).hexdigest()[:16]


def _location(span: Span) -> dict[str, Any]:
    region = {"startLine": span.line or 1, **({"startColumn": span.column} if span.column else {})}
    return {"physicalLocation": {"artifactLocation": {"uri": quote(span.file)}, "region": region}}
