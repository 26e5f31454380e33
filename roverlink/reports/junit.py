"""Findings as JUnit XML for CI servers: each rule is a test case, which fails on findings."""

from __future__ import annotations

from xml.etree import ElementTree

from roverlink.generator.diagnostics import Diagnostic, Rule, Severity
from roverlink.reports.reported import Reported
from roverlink.reports.repository_places import whole_text


def write(reported: Reported) -> None:
    """Print the findings as an XML document on standard output."""
    rules = {**reported.rules, **{finding.rule.id: finding.rule for finding in reported.findings}}
    suite = ElementTree.Element("testsuite", name=reported.command, tests=str(len(rules)))
    failed = [_add(suite, rule, reported) for _, rule in sorted(rules.items())]
    suite.set("failures", str(sum(failed)))
    ElementTree.indent(suite)
    print('<?xml version="1.0" encoding="UTF-8"?>')
    print(ElementTree.tostring(suite, encoding="unicode"))


def _add(suite: ElementTree.Element, rule: type[Rule], reported: Reported) -> bool:
    """Add a test case for a rule to the suite. Return true if the test case fails; hints do not make it fail."""
    case = ElementTree.SubElement(suite, "testcase", classname="roverlink", name=f"{rule.id} {rule.name}")
    # A hint does not fail the command either.
    faults = [found for found in reported.findings if found.rule == rule and found.severity is not Severity.HINT]
    if faults:
        failure = ElementTree.SubElement(case, "failure", message=faults[0].message, type=faults[0].severity.value)
        failure.text = "\n".join(_text(finding, reported) for finding in faults)
    return bool(faults)


def _text(finding: Diagnostic, reported: Reported) -> str:
    place = reported.sources.from_here(finding.span)
    text = whole_text(finding, reported, with_related=True)
    return f"{place}: {finding.severity.value}[{finding.rule.id}] {text}"
