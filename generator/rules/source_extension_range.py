"""A message has fewer numbers for extensions.

Extensions in other files, which may be in other repositories, do not compile any more, and their numbers look free for
fields.

Bad::

    message Rover { extensions 100 to 199; }   // before
    message Rover { extensions 100 to 149; }   // after

Good::

    message Rover { extensions 100 to 199; }
"""

from __future__ import annotations

from collections.abc import Iterator

from generator.changes import each_once, earlier, messages
from generator.changes.ranges import missing, spelled
from generator.findings import Finding, Rule, Severity
from generator.subject import Change, Subject

RULE = Rule("SRC110", "extension-range-narrowed", Severity.WARNING)


def check(subject: Subject) -> Iterator[Finding]:
    """Extension ranges of which something is no extension's any more."""
    return each_once(subject, _findings)


def _findings(change: Change) -> Iterator[Finding]:
    for pair in messages(change):
        for was in pair.old.extension_ranges:
            if gone := list(missing(was, pair.new.extension_ranges)):
                yield RULE.at(
                    pair.new.span,
                    f"{pair.new.full_name} does not leave {spelled(gone)} to extensions any more",
                    f"put back `extensions {spelled([was])};`",
                    earlier(change, pair.old.span, "it was declared here"),
                    type=pair.new.full_name,
                )
