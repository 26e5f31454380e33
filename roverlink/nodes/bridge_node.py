"""Declaration of the bridge's node, and what a table says about the topics of its rows."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
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
    rows: Mapping[str, Sequence[Topic]]
    """Topic of each row, then its extra topics, by the row's name, as the bridge has them."""


def read_table_nodes(path: Path) -> TableNodes | None:
    """Read a table; return None if it cannot be read, which other commands report."""
    ignored: list[Diagnostic] = []
    try:
        table = reader.read(path, ignored)
    except (DiagnosticsError, OSError):
        return None
    topics = {row.name: tuple(_topics_of(row, table.ros.package)) for row in table.rows}
    parameters = (
        *_parameters(has_link=table.link is not None),
        *(address for peer in table.peers for address in _addresses(peer)),
    )
    return TableNodes(
        table.ros.package,
        NodeDeclaration(NODE, tuple(topic for those in topics.values() for topic in those), parameters),
        topics,
    )


def _topics_of(row: Row, package: str) -> Iterator[Topic]:
    """Yield the topic of a row, then its extra topics, as the bridge has them."""
    direction = Direction.PUBLISHED if row.inbound else Direction.RECEIVED
    settings: tuple[StandardTopicSettings, ...] = (row, *row.also)
    for setting in settings:
        type_name = setting.ros.replace("/", "/msg/") if "/" in setting.ros else f"{package}/msg/{setting.ros}"
        profile = setting.profile
        qos = Qos(profile.reliability, profile.durability, profile.history, profile.depth)
        yield Topic(setting.topic, (type_name,), direction, f"row {row.name}", qos)


def _parameters(*, has_link: bool) -> Iterator[Parameter]:
    """Yield the parameters of every bridge, without those of the link message if the table has none."""
    for name, one in DECLARED.items():
        if one.of_link and not has_link:
            continue
        least, most = (one.minimum, one.maximum) if one.limits else (None, None)
        yield Parameter(name, type(one.default), one.description, one.default, one.read_only, least, most, one.choices)


def _addresses(peer: PeerSettings) -> Iterator[Parameter]:
    """Yield the parameters for the addresses of a peer or, if it has boards, of its boards."""
    for _, end in peer.ends:
        yield Parameter(end.parameter, int, f"UDP port of {end.name}", end.port, minimum=0, maximum=65_535)
        if end.host_parameter:
            yield Parameter(end.host_parameter, str, f"host of {end.name}", end.host)
