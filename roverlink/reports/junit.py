"""Findings of `roverlink lint` as JUnit XML for CI servers: each rule is a test case, which fails on findings."""

from __future__ import annotations

from xml.etree import ElementTree

from roverlink.generator.diagnostics import Diagnostic, Rule, Severity
from roverlink.generator.lint.project import Linted
from roverlink.generator.lint.rules import modules


def write(linted: Linted) -> None:
    """Print the findings as an XML document on standard output."""
    rules = {module.RULE.id: module.RULE for module in modules().values()}
    rules |= {finding.rule.id: finding.rule for finding in linted.findings}
    suite = ElementTree.Element("testsuite", name="roverlink lint", tests=str(len(rules)))
    failed = [_add(suite, rule, [f for f in linted.findings if f.rule == rule]) for _, rule in sorted(rules.items())]
    suite.set("failures", str(sum(failed)))
    ElementTree.indent(suite)
    print('<?xml version="1.0" encoding="UTF-8"?>')
    print(ElementTree.tostring(suite, encoding="unicode"))


def _add(suite: ElementTree.Element, rule: Rule, findings: list[Diagnostic]) -> bool:
    """Add a test case for a rule to the suite. Return true if the test case fails; hints do not make it fail."""
    case = ElementTree.SubElement(suite, "testcase", classname="roverlink", name=f"{rule.id} {rule.name}")
    # A hint does not fail the lint either.
    faults = [finding for finding in findings if finding.severity is not Severity.HINT]
    if faults:
        failure = ElementTree.SubElement(case, "failure", message=faults[0].message, type=faults[0].severity.value)
        failure.text = "\n".join(finding.render() for finding in faults)
    return bool(faults)
