"""Findings of `roverlink lint` as SARIF 2.1.0 (OASIS), a JSON format for services that show findings beside code."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any
from urllib.parse import quote

from roverlink.generator.diagnostics import Diagnostic, Rule, Severity, Span
from roverlink.generator.lint.project import Linted
from roverlink.generator.lint.rules import modules
from roverlink.lint_scope import sources

_LEVELS = {Severity.FATAL: "error", Severity.ERROR: "error", Severity.WARNING: "warning", Severity.HINT: "note"}
_SCHEMA = "https://json.schemastore.org/sarif-2.1.0.json"


def write(linted: Linted) -> None:
    """Print the findings as a SARIF document on standard output."""
    rules = {id: _rule(module.RULE) for id, module in modules().items()}
    rules |= {finding.rule.id: _rule(finding.rule) for finding in linted.findings}
    driver = {"name": "roverlink", "rules": [rules[id] for id in sorted(rules)]}
    run = {"tool": {"driver": driver}, "results": [_result(finding, linted) for finding in linted.findings]}
    print(json.dumps({"$schema": _SCHEMA, "version": "2.1.0", "runs": [run]}, indent=2))


def _rule(rule: Rule) -> dict[str, Any]:
    return {
        "id": rule.id,
        "name": rule.name,
        "shortDescription": {"text": rule.summary},
        "help": {"text": rule.documentation.strip()},
        "defaultConfiguration": {"level": _LEVELS[rule.severity]},
    }


def _result(finding: Diagnostic, linted: Linted) -> dict[str, Any]:
    files = sources(linted)
    text = f"{finding.message}\n{finding.help}" if finding.help else finding.message
    result: dict[str, Any] = {
        "ruleId": finding.rule.id,
        "level": _LEVELS[finding.severity],
        "message": {"text": text},
        "locations": [_location(files.from_here(finding.span))],
    }
    if finding.also:
        result["relatedLocations"] = [
            {**_location(files.from_here(span)), "message": {"text": files.with_commit(span, what)}}
            for span, what in finding.also
        ]
    return result


def _location(span: Span) -> Mapping[str, Any]:
    physical: dict[str, Any] = {"artifactLocation": {"uri": quote(span.file)}}
    if span.line:
        physical["region"] = {"startLine": span.line, **({"startColumn": span.column} if span.column else {})}
    return {"physicalLocation": physical}
