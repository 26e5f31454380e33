"""Declaration of the bridge's node, and what a table says about the topics of its rows."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from roverlink.generator.diagnostics import Diagnostic, DiagnosticsError
from roverlink.generator.table import reader
from roverlink.generator.table.keys import PeerSettings, Row, StandardTopicSettings
from roverlink.nodes import Direction, NodeDeclaration, Parameter, Topic
from roverlink.runtime import NODE
from roverlink.runtime.core.handler import Qos
from roverlink.runtime.ros_arguments.parameters import DECLARED


@dataclass(frozen=True, slots=True)
class TableNodes:
    """Node of the bridge of a table, and what the nodes of other programs have to know of the table."""

    package: str
    """ROS 2 package of the table's messages and of its bridge."""
    bridge: NodeDeclaration
    rows: Mapping[str, Topic]
    """Topic of each row by the row's name, as the bridge has it."""


def read_table_nodes(path: Path) -> TableNodes | None:
    """Read a table; return None if it cannot be read, which other commands report."""
    ignored: list[Diagnostic] = []
    try:
        table = reader.read(path, ignored)
    except (DiagnosticsError, OSError):
        return None
    topics = {row.name: tuple(_topics_of(row, table.ros.package)) for row in table.rows}
    parameters = (*_parameters(), *(one for peer in table.peers for one in _addresses(peer)))
    return TableNodes(
        table.ros.package,
        NodeDeclaration(NODE, tuple(topic for those in topics.values() for topic in those), parameters),
        {row: those[0] for row, those in topics.items()},
    )


def _topics_of(row: Row, package: str) -> Iterator[Topic]:
    """Yield the topic of a row, then its extra topics, as the bridge has them."""
    direction = Direction.PUBLISHED if row.inbound else Direction.RECEIVED
    settings: tuple[StandardTopicSettings, ...] = (row, *row.also)
    for one in settings:
        type_name = one.ros.replace("/", "/msg/") if "/" in one.ros else f"{package}/msg/{one.ros}"
        profile = one.profile
        qos = Qos(profile.reliability, profile.durability, profile.history, profile.depth)
        yield Topic(one.topic, (type_name,), direction, f"row {row.name}", qos)


def _parameters() -> Iterator[Parameter]:
    for name, one in DECLARED.items():
        least, most = (one.minimum, one.maximum) if one.limits else (None, None)
        yield Parameter(name, type(one.default), one.description, one.default, one.read_only, least, most, one.choices)


def _addresses(peer: PeerSettings) -> Iterator[Parameter]:
    """Yield the parameters for the addresses of a peer or, if it has boards, of its boards."""
    for _, end in peer.ends:
        yield Parameter(end.parameter, int, f"UDP port of {end.name}", end.port, minimum=0, maximum=65_535)
        if end.host_parameter:
            yield Parameter(end.host_parameter, str, f"host of {end.name}", end.host)
