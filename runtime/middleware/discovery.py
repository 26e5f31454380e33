"""Being seen as a node: the topic ``ros_discovery_info``, from which ``ros2 node list`` knows who has which endpoint.

ROS 2's own middlewares write there, per participant, the nodes it has and the GUIDs of their readers and writers. The
type is ``rmw_dds_common/msg/ParticipantEntitiesInfo``; its GIDs are 24 bytes up to Humble and 16 from Iron on.
"""

from __future__ import annotations

import dataclasses
import os
from dataclasses import dataclass
from typing import Annotated, Any

from cyclonedds.core import Entity
from cyclonedds.domain import DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.topic import Topic

from runtime import cdr
from runtime.handler import Qos
from runtime.messages import Bound, Length, Message
from runtime.middleware import NodeIdentity
from runtime.middleware.cyclone import RawWriter
from runtime.middleware.dds_types import carrier_type, dds_qos

_LONG_GID_DISTRIBUTIONS = frozenset({"dashing", "eloquent", "foxy", "galactic", "humble"})
_GUID_BYTES = 16
_QOS = Qos(durability="transient_local", depth=1)


@dataclass(slots=True)
class LongGid(Message):
    """A GUID and eight zero bytes."""

    __msgtype__ = "rmw_dds_common/msg/Gid"

    data: Annotated[bytes, Length(_GUID_BYTES + 8)]


@dataclass(slots=True)
class ShortGid(Message):
    """A GUID."""

    __msgtype__ = "rmw_dds_common/msg/Gid"

    data: Annotated[bytes, Length(_GUID_BYTES)]


@dataclass(slots=True)
class LongGidNode(Message):
    """A node and its endpoints, up to Humble."""

    __msgtype__ = "rmw_dds_common/msg/NodeEntitiesInfo"

    node_namespace: Annotated[str, Bound(256)]
    node_name: Annotated[str, Bound(256)]
    reader_gid_seq: list[LongGid] = dataclasses.field(default_factory=list)
    writer_gid_seq: list[LongGid] = dataclasses.field(default_factory=list)


@dataclass(slots=True)
class ShortGidNode(Message):
    """A node and its endpoints, from Iron on."""

    __msgtype__ = "rmw_dds_common/msg/NodeEntitiesInfo"

    node_namespace: Annotated[str, Bound(256)]
    node_name: Annotated[str, Bound(256)]
    reader_gid_seq: list[ShortGid] = dataclasses.field(default_factory=list)
    writer_gid_seq: list[ShortGid] = dataclasses.field(default_factory=list)


@dataclass(slots=True)
class LongGidParticipant(Message):
    """A participant and its nodes, up to Humble."""

    __msgtype__ = "rmw_dds_common/msg/ParticipantEntitiesInfo"

    gid: LongGid
    node_entities_info_seq: list[LongGidNode] = dataclasses.field(default_factory=list)


@dataclass(slots=True)
class ShortGidParticipant(Message):
    """A participant and its nodes, from Iron on."""

    __msgtype__ = "rmw_dds_common/msg/ParticipantEntitiesInfo"

    gid: ShortGid
    node_entities_info_seq: list[ShortGidNode] = dataclasses.field(default_factory=list)


class GraphAnnouncer:
    """Keeps the ROS 2 graph told of one node and its endpoints."""

    def __init__(self, participant: DomainParticipant, node: NodeIdentity) -> None:
        self._long = os.environ.get("ROS_DISTRO", "humble") in _LONG_GID_DISTRIBUTIONS
        self._participant, self._node = participant, node
        self._readers: list[Any] = []
        self._writers: list[Any] = []
        carrier = carrier_type(LongGidParticipant if self._long else ShortGidParticipant)
        topic = Topic(participant, "ros_discovery_info", carrier)
        self._entity: DataWriter[Any] = DataWriter(participant, topic, qos=dds_qos(_QOS, writing=True))
        self._writer = RawWriter(self._entity)
        self._announce()

    def add_reader(self, reader: Entity) -> None:
        """Tell of one more subscription."""
        self._readers.append(self._gid(reader))
        self._announce()

    def add_writer(self, writer: Entity) -> None:
        """Tell of one more publisher."""
        self._writers.append(self._gid(writer))
        self._announce()

    def _gid(self, entity: Entity) -> LongGid | ShortGid:
        guid = entity.guid.bytes
        return LongGid(guid + bytes(8)) if self._long else ShortGid(guid)

    def _announce(self) -> None:
        node_type, participant_type = (
            (LongGidNode, LongGidParticipant) if self._long else (ShortGidNode, ShortGidParticipant)
        )
        node: Any = node_type(self._node.namespace, self._node.name, self._readers, self._writers)
        participant: Any = self._gid(self._participant)
        self._writer.write([cdr.encode(participant_type(participant, [node]))])
