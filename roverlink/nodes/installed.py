"""Nodes that installed packages declare."""

from __future__ import annotations

from collections.abc import Mapping

from roverlink.installed_packages import entry_points
from roverlink.nodes import NodeDeclaration, Topic

ENTRY_POINTS = "roverlink.nodes"
"""Group of entry points: the name of a program, such as ``aruco_track``, and its `NodeDeclaration`."""


def declared_nodes() -> Mapping[str, NodeDeclaration]:
    """Return the declarations by the names of the programs."""
    return {entry.name: entry.load() for entry in entry_points(ENTRY_POINTS)}


def declared_topics() -> Mapping[str, Topic]:
    """Return the topics of these nodes by their names, apart from topics of rows and names with angle brackets."""
    topics = (topic for node in declared_nodes().values() for topic in node.topics)
    return {topic.name: topic for topic in topics if isinstance(topic, Topic) and "<" not in topic.name}
