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

from generator.changes import MessagePair, each_once, earlier, messages
from generator.changes.ranges import Range, covers, missing, spelled
from generator.diagnostics import Diagnostic, Rule, Severity
from generator.subject import Change, Subject

RULE = Rule("SRC110", "extension-range-narrowed", __doc__, Severity.WARNING)
_MESSAGE_SET = "message_set_wire_format"


def check(subject: Subject) -> Iterator[Diagnostic]:
    """Extension ranges of which something is no extension's any more; those of message sets are counted differently."""
    return each_once(subject, _findings)


def _findings(change: Change) -> Iterator[Diagnostic]:
    for pair in messages(change):
        if pair.old.facets.get(_MESSAGE_SET) != pair.new.facets.get(_MESSAGE_SET):
            continue
        for was in pair.old.extension_ranges:
            if gone := list(missing(was, pair.new.extension_ranges)):
                yield RULE.at(
                    pair.new.span,
                    f"{pair.new.full_name} does not leave {spelled(gone)} to extensions any more",
                    f"put back `extensions {spelled(gone)};`{_in_place_of(pair, gone)}",
                    earlier(change, pair.old.span, "it was declared here"),
                    type=pair.new.full_name,
                )


def _in_place_of(pair: MessagePair, gone: list[Range]) -> str:
    """What has to go from those numbers."""
    used = [f"{field.name} = {field.number}" for field in pair.new.fields if covers(gone, field.number)]
    reserved = any(list(missing(one, pair.new.reserved)) != [one] for one in gone)
    found = used + ["what reserves them"] * reserved
    return f" in place of {', and '.join(found)}" if found else ""
