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
from generator.changes.pairing import written
from generator.diagnostics import Diagnostic, Rule, Severity, Span
from generator.protos import ProtoField
from generator.subject import Change, Subject

RULE = Rule("SRC116", "utf8-validation-changed", __doc__, Severity.WARNING)
_CHECKED = "VERIFY"
_FEATURES = '"google/protobuf/java_features.proto"'
_IS_CHECKED = (
    "is checked for UTF-8{} now and was not",
    "it was not checked here",
    "where it is not UTF-8, a receiver refuses the whole message",
)
_IS_NOT_CHECKED = (
    "is not checked for UTF-8{} any more",
    "it was checked here",
    "what is not UTF-8 is handed on",
)
_EVERYWHERE, _IN_JAVA = "utf8_validation", "java_utf8_validation"


def check(subject: Subject) -> Iterator[Diagnostic]:
    """Strings with another `utf8_validation`, or with another for Java alone."""
    return each_once(subject, _findings)


def _findings(change: Change) -> Iterator[Diagnostic]:
    for pair in fields(change):
        for facet, where in ((_EVERYWHERE, ""), (_IN_JAVA, " in Java")):
            old, new = _values(pair, facet)
            if old and new and old != new:
                now, was, lost = _IS_CHECKED if new == _CHECKED else _IS_NOT_CHECKED
                yield RULE.at(
                    _place(pair.new, facet),
                    f"{_what(pair)} {now.format(where)}: {lost}",
                    _help_of_java(pair, old) if where else _help(pair, old),
                    earlier(change, _place(pair.old, facet), was),
                    type=pair.owner,
                    number=pair.new.number,
                )
                break


def _what(pair: FieldPair) -> str:
    of_map = written(pair).new
    what = f"{of_map.name} = {of_map.number}"
    return f"the {pair.new.name} of the map {what}" if pair.in_map_entry else what


def _help(pair: FieldPair, old: str) -> str:
    if not pair.syntax.is_edition:
        return f"put back `{pair.old_syntax.statement}`"
    return f"write `[features.utf8_validation = {old}]` behind it"


def _help_of_java(pair: FieldPair, old: str) -> str:
    option = "option java_string_check_utf8 = true;"
    if pair.syntax.is_edition:
        if old == _CHECKED:
            return f"write `[features.(pb.java).utf8_validation = {old}]` behind it, and `import {_FEATURES};`"
        return "take `features.(pb.java).utf8_validation` out again"
    return f"put back `{option}`" if old == _CHECKED else f"remove `{option}`"


def _values(pair: FieldPair, facet: str) -> tuple[str, str]:
    return pair.old.facets.get(facet, ""), pair.new.facets.get(facet, "")


def _place(field: ProtoField, facet: str) -> Span:
    return field.places.get(facet) or field.places.get("features") or field.span
