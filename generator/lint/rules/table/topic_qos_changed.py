"""A topic of a published row has another quality of service (QoS) than before.

A best-effort publisher does not reach a reliable subscriber, and a volatile one no `transient_local` subscriber. Such a
node gets nothing, and only a warning in its log. A shorter queue loses messages in a burst. The next `roverlink
generate` writes the new QoS into the ledger (mapping.lock), so this warning appears once.

Bad::

    # mapping.lock says `12 SensorBoardGPSInfo qos: reliable volatile keep_last 10`
    - number: 12
      name: gps_info
      proto: SensorBoardGPSInfo
      topic: gps_data
      direction: hardware_to_ros
      qos: {reliability: best_effort}

Good::

    - {number: 12, name: gps_info, proto: SensorBoardGPSInfo, topic: gps_data, direction: hardware_to_ros}
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule, Severity
from roverlink.generator.lint.context import Context

RULE = Rule("TAB113", "topic-qos-changed", __doc__, Severity.WARNING)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each topic that was published with another QoS."""
    for row, topic, _, change in context.changed_topics():
        if change and change.now:
            message = f"the topic {topic!r} has the QoS {change.now.text!r}; {change.published}"
            help, span = "restore the old QoS, or check all nodes that use the topic", change.now.span
            yield context.diagnostic_of_change(RULE, row, change, message, help, span, rests_on=span)
