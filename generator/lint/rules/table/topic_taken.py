"""A topic stands in two rows, or twice in one.

A topic has one type and one meaning; two rows on one topic would mix two payloads, or echo each other in a loop.

Bad::

    - {number: 12, name: gps, proto: SensorBoardGPSInfo, topic: sensors, direction: hardware_to_ros}
    - {number: 13, name: imu, proto: SensorBoardIMUInfo, topic: sensors, direction: hardware_to_ros}

Good::

    - {number: 12, name: gps, proto: SensorBoardGPSInfo, topic: sensors/gps, direction: hardware_to_ros}
    - {number: 13, name: imu, proto: SensorBoardIMUInfo, topic: sensors/imu, direction: hardware_to_ros}
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule, Span
from roverlink.generator.lint.context import Context
from roverlink.generator.table import Row

RULE = Rule("TAB102", "topic-taken", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Rows whose topic an earlier row has."""
    seen: dict[str, tuple[str, Span]] = {}
    envelope = context.table.envelope.message
    for row in context.table.rows:
        for topic, span in _topics(row):
            # a node's namespace is the root, mostly
            first, place = seen.setdefault(topic.removeprefix("/"), (row.name, span))
            if place is not span:
                message = f"the topic {topic} is already that of {first}"
                help = "give each row a topic of its own"
                yield RULE.at(span, message, help, [(place, "first used here")], type=envelope, number=row.number)


def _topics(row: Row) -> Iterator[tuple[str, Span]]:
    """A row's topics, those under `also` among them; none of a member of an envelope without a table."""
    if row.topic:
        yield row.topic, row.at("topic")
    yield from ((standard.topic, standard.at("topic")) for standard in row.also)
