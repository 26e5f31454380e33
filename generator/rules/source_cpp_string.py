"""A string has another type in C++.

With `ctype` or the feature `(pb.cpp).string_type`, code has a string, a view or a cord.

Bad::

    message Log { string text = 1; }                  // before
    message Log { string text = 1 [ctype = CORD]; }   // after

Good::

    message Log { string text = 1; }
"""

from __future__ import annotations

from collections.abc import Iterator

from generator.changes import FieldPair, each_once, earlier, fields
from generator.diagnostics import Diagnostic, Rule, Severity, Span
from generator.protos import ProtoField
from generator.subject import Change, Subject

RULE = Rule("SRC115", "cpp-string-type-changed", __doc__, Severity.WARNING)
_FEATURES = '"google/protobuf/cpp_features.proto"'
_WITH_CTYPE = ("proto2", "proto3", "2023")
_HARMLESS = ("STRING_PIECE", "STRING")  # the one was never more than the other


def check(subject: Subject) -> Iterator[Diagnostic]:
    """Strings and bytes with another type in C++."""
    return each_once(subject, _findings)


def _findings(change: Change) -> Iterator[Diagnostic]:
    for pair in fields(change):
        old, new = (field.facets.get("cpp_string_type", "") for field in (pair.old, pair.new))
        if old and new and old != new and (old, new) != _HARMLESS and not pair.in_map_entry:
            yield RULE.at(
                _place(pair.new),
                f"{pair.new.name} = {pair.new.number} was a {_shown(old)} in C++ and is a {_shown(new)} now",
                _help(pair, old),
                earlier(change, _place(pair.old), f"it was a {_shown(old)} here"),
                type=pair.owner,
                number=pair.new.number,
            )


def _shown(type: str) -> str:
    return type.lower().replace("_", " ")


def _help(pair: FieldPair, old: str) -> str:
    ctype = pair.new.facets.get("ctype")
    if ctype and "ctype" not in pair.old.facets:
        return f"remove `ctype = {ctype}`"
    if not pair.syntax.is_edition and pair.old_syntax.is_edition:
        return f"put back `{pair.old_syntax.statement}`"
    if "ctype" in pair.old.facets and pair.syntax.name in _WITH_CTYPE:
        return f"put back `[ctype = {old}]` behind it"
    return f"write `[features.(pb.cpp).string_type = {old}]` behind it, and `import {_FEATURES};`"


def _place(field: ProtoField) -> Span:
    said = (field.places.get(part) for part in ("ctype", "cpp_string_type", "features"))
    return next((span for span in said if span), field.span)
