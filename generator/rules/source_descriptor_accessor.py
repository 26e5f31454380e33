"""A message has no `descriptor()` in generated code any more.

The option `no_standard_descriptor_accessor` takes it out, lest it clash with a field of that name.

Bad::

    message Imu { float heading = 1; }                                                  // before
    message Imu { option no_standard_descriptor_accessor = true; float heading = 1; }   // after

Good::

    message Imu { float heading = 1; }
"""

from __future__ import annotations

from collections.abc import Iterator

from generator.changes import each_once, earlier, messages
from generator.diagnostics import Diagnostic, Rule, Severity
from generator.subject import Change, Subject

RULE = Rule("SRC111", "descriptor-accessor-removed", __doc__, Severity.WARNING)
_OPTION = "no_standard_descriptor_accessor"


def check(subject: Subject) -> Iterator[Diagnostic]:
    """Messages that have the option and had it not."""
    return each_once(subject, _findings)


def _findings(change: Change) -> Iterator[Diagnostic]:
    for pair in messages(change):
        if _OPTION in pair.new.facets and _OPTION not in pair.old.facets and not change.of_ledger:
            yield RULE.at(
                pair.new.at(_OPTION),
                f"{pair.new.full_name} has no standard descriptor accessor any more",
                f"remove `option {_OPTION} = true;`",
                earlier(change, pair.old.span, "it had one here"),
                type=pair.new.full_name,
            )
