"""A published row has another topic than before.

Subscribers and publishers of the old topic get no error: the topic is just silent. The next `generate` writes the new
topic into the ledger, so this warning appears once.

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

RULE = Rule("TAB107", "topic-changed", __doc__, Severity.WARNING)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each row that was published with the same number and message, but with another topic."""
    envelope = context.table.envelope.message
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
