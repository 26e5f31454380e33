"""Two rows have the same topic, or one row has it twice.

A topic has one type and one meaning. Two rows with one topic would mix two payloads. If one row receives and the other
sends, the rows would send each other's messages back in a loop.

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
    """Yield a diagnostic for each row with a topic that an earlier row, or the row itself, already has."""
    seen: dict[str, tuple[str, Span]] = {}
    envelope = context.table.envelope.message
    for row in context.table.rows:
        for topic, span in _topics(row):
            # usually a node is in the root namespace, where `gps` and `/gps` are the same topic
            first, place = seen.setdefault(topic.removeprefix("/"), (row.name, span))
            if place is not span:
                message = f"the topic {topic!r} already belongs to the row {first!r}"
                help = "give each row its own topic"
                yield RULE.at(span, message, help, [(place, "first used here")], type=envelope, number=row.number)


def _topics(row: Row) -> Iterator[tuple[str, Span]]:
    """Yield the topics of a row with their places: its own topic and its extra topics.

    Rows that were made from an envelope without a table have none.
    """
    if row.topic:
        yield row.topic, row.at("topic")
    yield from ((standard.topic, standard.at("topic")) for standard in row.also)
