"""A name that ROS 2 forbids.

Packages are lower case with single underscores, messages are CamelCase without underscores, topics are names separated
by slashes. rosidl and rcl refuse anything else, long after the table was written.
"""

from __future__ import annotations

from collections.abc import Iterator

from generator import naming
from generator.findings import Finding, Rule
from generator.subject import Subject

RULE = Rule("ROS101", "ros-name-forbidden")


def check(subject: Subject) -> Iterator[Finding]:
    """The package, and the messages and topics of the rows."""
    table = subject.table
    if table.package and not naming.is_package_name(table.package):
        help = "lower case letters, digits and single underscores, for example rover_msgs"
        yield RULE.at(table.package_span, f"ROS forbids the package name {table.package!r}", help)
    for row in table.rows:
        if not naming.is_message_name(row.ros):
            nearest = naming.camel_case(row.ros)
            example = nearest if naming.is_message_name(nearest) else "ImuInfo"
            help = f"letters and digits, starting with a capital: {example}"
            yield RULE.at(row.ros_span, f"ROS forbids the message name {row.ros!r}", help)
        if not naming.is_topic_name(row.topic):
            help = "letters, digits and underscores, separated by single slashes; no part starts with a digit"
            yield RULE.at(row.at("topic"), f"ROS forbids the topic name {row.topic!r}", help)
