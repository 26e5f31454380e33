"""The default value of a field changed, so an absent field is read as another value than before.

A message does not contain the default. If the sender does not set the field, nothing is sent for it, and the receiver
uses the default that it was compiled with. After the change, old and new programs read different values from the same
message.

Bad::

    message Pid { optional float gain = 1 [default = 1.5]; }   // before
    message Pid { optional float gain = 1 [default = 2]; }     // after

Good::

    message Pid { optional float gain = 1 [default = 1.5]; }   // and send 2 where 2 is meant
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule
from roverlink.generator.lint.comparison import FieldPair, SchemaChange, each_once, fields
from roverlink.generator.lint.comparison.default_values import default, default_changed, shown
from roverlink.generator.lint.comparison.field_type_changes import broken_by_type
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.fixits.declarations import declaration
from roverlink.generator.lint.fixits.put_back_or_reserve import back

RULE = Rule("WIR108", "field-default-changed", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each field with another default than before.

    Fields with an incompatible type are left out.
    """
    return each_once(context.changes, _findings)


def _findings(change: SchemaChange) -> Iterator[Diagnostic]:
    for pair in fields(change):
        if default_changed(pair) and not broken_by_type(pair):
            old, new = shown(pair.old, change.before), shown(pair.new, change.after)
            yield RULE.at(
                pair.new.at("default"),
                f"`{pair.new.name} = {pair.new.number}`, if absent, was read as {old}, and is now read as {new}",
                f"{_undo(pair)}, and set the field to {new} in each message where this value is meant",
                change.earlier(pair.old.at("default"), f"it was {old} here"),
                type=pair.owner,
                number=pair.new.number,
            )


def _undo(pair: FieldPair) -> str:
    if (pair.old.type, pair.old.type_name) != (pair.new.type, pair.new.type_name):
        return back(pair)
    if "default" in pair.new.facets and "default" not in pair.old.facets:
        return "remove the default again"
    value = _old_value(pair)
    declared = _with_default(pair, value) if value and pair.syntax.name != "proto3" else ""
    if "default" in pair.old.facets:
        return f"put back `{declared}`" if declared else back(pair)
    first = f"put {value or shown(pair.old, pair.change.before)} first in the enum {pair.new.type_name!r} again"
    return f"write `{declared}`, or {first}" if declared else first


def _old_value(pair: FieldPair) -> str:
    """Return the old default of a field; for an enum, the current name of its number, or empty if there is none."""
    if pair.new.type != "enum":
        return pair.old.facets["default"]
    number = default(pair.old, pair.change.before)
    values = pair.change.after.enums[pair.new.type_name].values
    return next((value.name for value in values if value.number == number), "")


def _with_default(pair: FieldPair, value: str) -> str:
    field = dataclasses.replace(pair.new, facets={**pair.new.facets, "default": value})
    return declaration(field, pair.change.after, pair.owner, pair.syntax)
