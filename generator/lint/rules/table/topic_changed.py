"""A published row has another topic than before, or lost an extra topic.

Subscribers and publishers of the old topic get no error: the topic is just silent. The next `roverlink
generate` writes the new topic into the ledger (mapping.lock), so this warning appears once.

Bad::

    # mapping.lock says `12: gps_info SensorBoardGPSInfo on gps_data`
    - {number: 12, name: gps_info, proto: SensorBoardGPSInfo, topic: gps, direction: hardware_to_ros}

Good::

    - {number: 12, name: gps_info, proto: SensorBoardGPSInfo, topic: gps_data, direction: hardware_to_ros}
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule, Severity, Span
from roverlink.generator.lint.context import Context
from roverlink.generator.lock import EXTRA_TOPIC, topics_of

RULE = Rule("TAB107", "topic-changed", __doc__, Severity.WARNING)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each topic that a row with the same number and message was published with, and lost."""
    envelope = context.table.envelope.message
    topics = {topic.topic for row in context.table.rows for topic, *_ in topics_of(row)}
    for row in context.table.rows:
        before: dict[str, Span] = {}
        for entry in context.published:
            if (entry.number, entry.proto) == (row.number, row.proto) and entry.topic not in ("", row.topic):
                before.setdefault(entry.topic, entry.span)
        if row.topic and before:
            message = (
                f"{row.name!r} has the topic {row.topic!r}; it was published on {' and on '.join(map(repr, before))}"
            )
            help = "restore the old topic, or change all nodes that use it"
            also = [(span, f"{topic!r} was the topic here") for topic, span in before.items()]
            rests_on = [row.at("number"), row.at("topic")]
            yield RULE.at(row.at("topic"), message, help, also, type=envelope, number=row.number, rests_on=rests_on)
        for key, change in context.changed_settings(row).items():
            topic = key.removeprefix(EXTRA_TOPIC)
            # the key of the topic's QoS has a further word
            if change.now is None and key.startswith(EXTRA_TOPIC) and " " not in topic and topic not in topics:
                message = f"{row.name!r} has no extra topic {topic!r} any more; {change.published}"
                help = "restore the extra topic, or change all nodes that use it"
                rests_on, also = [row.at("number"), row.at("proto")], change.related()
                yield RULE.at(row.at("topic"), message, help, also, type=envelope, number=row.number, rests_on=rests_on)
