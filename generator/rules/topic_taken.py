"""A topic stands in two rows.

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

from generator.findings import Finding, Rule
from generator.subject import Subject
from generator.table import Row

RULE = Rule("TAB102", "topic-taken")


def check(subject: Subject) -> Iterator[Finding]:
    """Rows whose topic an earlier row has."""
    seen: dict[str, Row] = {}
    envelope = subject.table.envelope.message
    for row in subject.table.rows:
        if not row.topic:
            continue
        first = seen.setdefault(row.topic.removeprefix("/"), row)  # a node's namespace is the root, mostly
        if first is not row:
            message = f"the topic {row.topic} is already that of {first.name}"
            also = [(first.at("topic"), "first used here")]
            help = "give each row a topic of its own"
            yield RULE.at(row.at("topic"), message, help, also, type=envelope, number=row.number)
