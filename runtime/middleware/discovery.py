"""Announcement of our node, its publishers and its subscriptions on the topic ``ros_discovery_info``.

`ros2 node list` reads this topic. There, ROS 2's own middlewares publish a
``rmw_dds_common/msg/ParticipantEntitiesInfo`` for each DDS participant: its nodes, and the GUIDs of their readers and
writers. In this message a GUID is called a GID. A GID has 24 bytes up to Humble and 16 bytes since Iron. The topic's
DDS name has no ``rt/`` prefix.
"""

from __future__ import annotations

import os
from dataclasses import make_dataclass
from typing import Annotated, Any

from cyclonedds.core import Entity
from cyclonedds.domain import DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.topic import Topic

from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Qos
from roverlink.runtime.core.messages import Bound, Length, Message
from roverlink.runtime.middleware.cyclone import RawWriter
from roverlink.runtime.middleware.dds_types import dds_qos, dds_type
from roverlink.runtime.middleware.protocol import NodeIdentity

_LONG_GID_DISTRIBUTIONS = frozenset({"dashing", "eloquent", "foxy", "galactic", "humble"})
_GUID_BYTES = 16
_LONG_GID_BYTES = 24
# Transient local, so that nodes and tools that start later get it too.
_QOS = Qos(durability="transient_local", depth=1)


def _message(name: str, fields: list[tuple[str, Any]]) -> Any:
    """Make a message class of the package rmw_dds_common; each field is a pair of its name and its annotation."""
    return make_dataclass(name, fields, bases=(Message,), namespace={"__msgtype__": f"rmw_dds_common/msg/{name}"})


class GraphTypes:
    """Message classes of the package rmw_dds_common, for one size of GIDs (16 or 24 bytes)."""

    def __init__(self, gid_bytes: int) -> None:
        name = Annotated[str, Bound(256)]
        self.gid = _message("Gid", [("data", Annotated[bytes, Length(gid_bytes)])])
        gids = list.__class_getitem__(self.gid)
        self.node = _message(
            "NodeEntitiesInfo",
            [("node_namespace", name), ("node_name", name), ("reader_gid_seq", gids), ("writer_gid_seq", gids)],
        )
        nodes = list.__class_getitem__(self.node)
        self.participant = _message("ParticipantEntitiesInfo", [("gid", self.gid), ("node_entities_info_seq", nodes)])


class GraphAnnouncer:
    """Announces one node with its publishers and subscriptions to the ROS 2 graph."""

    def __init__(self, participant: DomainParticipant, node: NodeIdentity) -> None:
        long = os.environ.get("ROS_DISTRO", "humble") in _LONG_GID_DISTRIBUTIONS
        self._gid_bytes = _LONG_GID_BYTES if long else _GUID_BYTES
        self.types = GraphTypes(self._gid_bytes)
        self._participant, self._node = participant, node
        self._readers: list[Any] = []
        self._writers: list[Any] = []
        self.topic: Topic[Any] = Topic(participant, "ros_discovery_info", dds_type(self.types.participant))
        self._entity: DataWriter[Any] = DataWriter(participant, self.topic, qos=dds_qos(_QOS, writing=True))
        self._writer = RawWriter(self._entity)
        # Once without endpoints, so that the node is listed before its first topic.
        self._announce()

    def add_reader(self, reader: Entity) -> None:
        """Announce a new subscription of the node to the ROS 2 graph; ``reader`` is its DDS reader."""
        self._readers.append(self._gid(reader))
        self._announce()

    def remove_reader(self, reader: Entity) -> None:
        """Announce that a subscription of the node has ended. The DDS reader must still exist."""
        self._readers.remove(self._gid(reader))
        self._announce()

    def add_writer(self, writer: Entity) -> None:
        """Announce a new publisher of the node to the ROS 2 graph; ``writer`` is its DDS writer."""
        self._writers.append(self._gid(writer))
        self._announce()

    def _gid(self, entity: Entity) -> Any:
        """Return the GID of a DDS entity: its GUID, padded with zeros to the size of a GID."""
        # The GUID of RTPS has 16 bytes: 12 of the participant and 4 of the entity. Humble's rmw has room for 24.
        return self.types.gid(entity.guid.bytes.ljust(self._gid_bytes, b"\0"))

    def _announce(self) -> None:
        # The topic keeps one sample for each participant, so each announcement lists all endpoints.
        node = self.types.node(self._node.namespace, self._node.name, self._readers, self._writers)
        self._writer.write([cdr.encode(self.types.participant(self._gid(self._participant), [node]))])
