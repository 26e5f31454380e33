"""A string is checked for UTF-8 now and was not before, or the other way round.

Who checks refuses the whole message where a string is not UTF-8; who does not hands it on.

Bad::

    message Log { string text = 1; }                                       // before, in an edition
    message Log { string text = 1 [features.utf8_validation = NONE]; }     // after

Good::

    message Log { string text = 1; }
"""

from __future__ import annotations

from collections.abc import Iterator

from generator.changes import FieldPair, each_once, earlier, fields
from generator.findings import Finding, Rule, Severity, Span
from generator.protos import ProtoField
from generator.subject import Change, Subject

RULE = Rule("SRC116", "utf8-validation-changed", Severity.WARNING)
_EVERYWHERE, _IN_JAVA = "utf8_validation", "java_utf8_validation"


def check(subject: Subject) -> Iterator[Finding]:
    """Strings with another `utf8_validation`, or with another for Java alone."""
    return each_once(subject, _findings)


def _findings(change: Change) -> Iterator[Finding]:
    for pair in fields(change):
        for facet, where in ((_EVERYWHERE, ""), (_IN_JAVA, " in Java")):
            old, new = _values(pair, facet)
            if old and new and old != new:
                yield RULE.at(
                    _place(pair.new, facet),
                    f"utf8_validation of {pair.new.name} = {pair.new.number} was {old} and is {new} now{where}",
                    f"put back `features.utf8_validation = {old}`",
                    earlier(change, _place(pair.old, facet), f"it was {old} here"),
                    type=pair.owner,
                    number=pair.new.number,
                )
                break


def _values(pair: FieldPair, facet: str) -> tuple[str, str]:
    return pair.old.facets.get(facet, ""), pair.new.facets.get(facet, "")


def _place(field: ProtoField, facet: str) -> Span:
    return field.places.get(facet) or field.places.get("features") or field.span
