"""ROS 2 does not allow a name in the table.

Package names are lower case with single underscores. Message names are CamelCase without underscores. Topics are names
separated by slashes. rosidl and rcl reject anything else, but only when the package is built or the node starts.

Bad::

    - {number: 12, name: gps, proto: GPS_Info, topic: gps//data, direction: hardware_to_ros}

Good::

    - {number: 12, name: gps, proto: GPS_Info, ros: GPSInfo, topic: gps/data, direction: hardware_to_ros}
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule
from roverlink.generator.ir import ros_names
from roverlink.generator.lint.context import Context
from roverlink.generator.table import Row

RULE = Rule("ROS101", "ros-name-forbidden", __doc__)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each name of the package, a row's message or a topic that ROS 2 does not allow."""
    table = context.table
    if table.ros.package and not ros_names.is_package_name(table.ros.package):
        help = "use lower-case letters, digits and single underscores, for example rover_msgs"
        yield RULE.at(
            table.ros.at("package"), f"{table.ros.package!r} is not allowed as the name of a ROS package", help
        )
    for row in filter(_reaches_ros, table.rows):
        if row.standard is None and not ros_names.is_message_name(row.ros):
            nearest = ros_names.camel_case(row.ros)
            example = nearest if ros_names.is_message_name(nearest) else "ImuInfo"
            help = f"use letters and digits, and start with a capital, for example {example}"
            message = f"{row.ros!r} is not allowed as the name of a ROS message"
            yield RULE.at(row.ros_span, message, help, type=table.envelope.message, number=row.number)
        for topic, span in (
            (row.topic, row.at("topic")),
            *((standard.topic, standard.at("topic")) for standard in row.also),
        ):
            if not ros_names.is_topic_name(topic):
                help = (
                    "use letters, digits and underscores, separated by single slashes; no part may start with a digit"
                )
                message = f"{topic!r} is not allowed as the name of a topic"
                yield RULE.at(span, message, help, type=table.envelope.message, number=row.number)


def _reaches_ros(row: Row) -> bool:
    """Return True if the row has a topic. Rows that were made from an envelope without a table have none."""
    return bool(row.topic)
