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
from roverlink.generator.lint.comparison import MessagePair, SchemaChange, each_once, fields_of_messages, messages
from roverlink.generator.lint.comparison.field_renames import Rename, rename
from roverlink.generator.lint.comparison.field_type_changes import broken_by_type
from roverlink.generator.lint.context import Context

RULE = Rule("WIR113", "message-content-replaced", __doc__)
_FEWEST = 3  # with fewer fields, each one may have changed on its own


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each message that kept its name, but fewer than a third of its fields.

    At least half of the old field numbers must have a new meaning.
    """
    return each_once(context.changes, _findings)


def _findings(change: SchemaChange) -> Iterator[Diagnostic]:
    for pair in messages(change):
        before = len(pair.old.fields)
        replaced, left = _counts(pair)
        if before >= _FEWEST and left * 3 < before <= replaced * 2:
            counted = f"{replaced} of {before} fields were replaced, {left} kept"
            yield RULE.at(
                pair.new.at("name"),
                f"{pair.new.full_name!r} is now another message: {counted}",
                "give the new message another name, and restore the old message",
                change.earlier(pair.old.at("name"), "the old message is here"),
                type=pair.new.full_name,
            )


def _counts(pair: MessagePair) -> tuple[int, int]:
    """Return the count of field numbers with a new meaning, and the count of those with the same meaning as before."""
    same = 0
    pairs = list(fields_of_messages(pair))
    for one in pairs:
        retyped = broken_by_type(one)
        renamed = one.old.name != one.new.name
        same += not (renamed if retyped else rename(one) is Rename.MEANING)
    return len(pairs) - same, same
