"""A message has other content than the message that had its name before.

Most field numbers of the message belong to fields with other names and other types. The name of the message stayed the
same, so boards and rows of the table mistake one message for the other.

Bad::

    message Status { float voltage = 1; float current = 2; int32 load = 3; }   // before
    message Status { string text = 1; bool busy = 2; Mode mode = 3; }          // after

Good::

    message PowerStatus { float voltage = 1; float current = 2; int32 load = 3; }
    message TaskStatus { string text = 1; bool busy = 2; Mode mode = 3; }
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule
from roverlink.generator.lint.comparison import SchemaChange, each_once, messages
from roverlink.generator.lint.comparison.judged_changes import type_state
from roverlink.generator.lint.comparison.judgement import compare_parts
from roverlink.generator.lint.context import Context

RULE = Rule("WIR113", "message-content-replaced", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each message that kept its name, but fewer than a third of its fields.

    At least half of the old field numbers must have a new meaning.
    """
    return each_once(context.changes, _findings)


def _findings(change: SchemaChange) -> Iterator[Diagnostic]:
    for pair in messages(change):
        parts = compare_parts(type_state(pair.old, change.before), type_state(pair.new, change.after))
        if parts.is_another_message:
            counted = f"{parts.replaced} of {parts.before} fields were replaced, {parts.left} kept"
            yield RULE.at(
                pair.new.at("name"),
                f"{pair.new.full_name!r} is now another message: {counted}",
                "give the new message another name, and restore the old message",
                change.earlier(pair.old.at("name"), "the old message is here"),
                type=pair.new.full_name,
            )
