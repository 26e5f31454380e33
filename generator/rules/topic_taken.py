"""A topic stands in two rows.

A topic has one type and one meaning; two rows on one topic would mix two payloads, or echo each other in a loop.
"""

from __future__ import annotations

from collections.abc import Iterator

from generator.findings import Finding, Rule
from generator.subject import Subject
from generator.table import Row

RULE = Rule("TAB102", "topic-taken")


def check(subject: Subject) -> Iterator[Finding]:
    """Rows whose topic an earlier row has."""
    seen: dict[str, Row] = {}
    for row in subject.table.rows:
        first = seen.setdefault(row.topic.removeprefix("/"), row)  # a node's namespace is the root, mostly
        if first is not row:
            message = f"the topic {row.topic} is already that of {first.name}"
            yield RULE.at(
                row.at("topic"), message, "give each row a topic of its own", [(first.at("topic"), "first used here")]
            )
