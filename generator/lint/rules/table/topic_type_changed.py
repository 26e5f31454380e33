"""A topic of a published row has another ROS 2 message than before.

Topics with different types do not connect. A node that still uses the old message gets nothing, and reports no error.
The same holds for a bag that was recorded with the old message. The next `roverlink generate` writes the new message
into the ledger (mapping.lock), so this warning appears once.

Bad::

    # mapping.lock says `12 SensorBoardGPSInfo ros: comms/GpsInfo`
    - {number: 12, name: gps_info, proto: SensorBoardGPSInfo, ros: Gps, topic: gps_data, direction: hardware_to_ros}

Good::

    - {number: 12, name: gps_info, proto: SensorBoardGPSInfo, ros: GpsInfo, topic: gps_data, direction: hardware_to_ros}
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule, Severity
from roverlink.generator.lint.context import Context

RULE = Rule("TAB112", "topic-type-changed", __doc__, Severity.WARNING)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each topic that was published with another ROS 2 message."""
    for row, topic, change, _ in context.changed_topics():
        if change and change.now:
            message = f"the topic {topic!r} has the message {change.now.text!r}; {change.published}"
            help, span = "restore the old message, or change all nodes that use the topic", change.now.span
            yield context.diagnostic_of_change(RULE, row, change, message, help, span, rests_on=span)
