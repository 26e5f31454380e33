"""The option `message_set_wire_format` of a message changed.

With this option, each extension is encoded as a group that contains the number of the extension. A program that uses
one of the two formats cannot read the other.

Bad::

    message Extras { extensions 4 to max; }   // before
    message Extras { option message_set_wire_format = true; extensions 4 to max; }   // after

Good::

    message Extras { extensions 4 to max; }
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule
from roverlink.generator.lint.comparison import SchemaChange, each_once, messages
from roverlink.generator.lint.context import Context

RULE = Rule("WIR109", "message-set-format-changed", __doc__)
_OPTION = "message_set_wire_format"


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each message whose option `message_set_wire_format` changed."""
    return each_once(context.changes, _findings)


def _findings(change: SchemaChange) -> Iterator[Diagnostic]:
    for pair in messages(change):
        old, new = (message.facets.get(_OPTION, "false") for message in (pair.old, pair.new))
        if old != new and not change.of_ledger:
            yield RULE.at(
                pair.new.span,
                f"{_OPTION} of {pair.new.full_name!r} was {old}, and is now {new}: no program reads both formats",
                f"put back `option {_OPTION} = true;`" if old == "true" else f"remove `option {_OPTION} = true;`",
                change.earlier(pair.old.span, f"it was {old} here"),
                type=pair.new.full_name,
            )
