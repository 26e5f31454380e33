"""Publishers and subscriptions of all nodes in a DDS domain, with their QoS and the names of their nodes.

DDS identifies writers and readers by GUID, and announces their QoS. The names of the nodes come from the topic
``ros_discovery_info`` (module `discovery`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsPublication, BuiltinTopicDcpsSubscription
from cyclonedds.core import InstanceState
from cyclonedds.domain import DomainParticipant
from cyclonedds.qos import Policy
from cyclonedds.qos import Qos as DdsQos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import ConversionError
from roverlink.runtime.core.handler import Qos
from roverlink.runtime.core.messages import Message
from roverlink.runtime.middleware.cyclone import RawReader
from roverlink.runtime.middleware.dds_names import ros_type_name
from roverlink.runtime.middleware.dds_types import dds_qos
from roverlink.runtime.middleware.protocol import Endpoint, NodeIdentity

_TAKE = 256  # most samples taken at a time
# All nodes publish on this topic, which has no keys: with keep_last, a node's sample would replace that of another.
_ALL_NODES = Qos(durability="transient_local", history="keep_all")
_INFINITE = duration(infinite=True)
_PREFIX = "rt"
"""Start of the DDS name of a ROS 2 topic."""


class DdsGraph:
    """Reader of the ROS 2 graph, through one DDS participant. Each call reads only the changes since the last call."""

    def __init__(self, participant: DomainParticipant, discovery: Topic[Any], discovery_type: type[Message]) -> None:
        """Start to read; ``discovery`` is the topic ``ros_discovery_info``, with messages of ``discovery_type``."""
        self._readers = {
            True: BuiltinDataReader(participant, BuiltinTopicDcpsPublication),
            False: BuiltinDataReader(participant, BuiltinTopicDcpsSubscription),
        }
        self._nodes = RawReader(DataReader(participant, discovery, qos=dds_qos(_ALL_NODES, writing=False)))
        self._node_type: Any = discovery_type
        self._found: dict[bool, dict[bytes, tuple[str, str, DdsQos]]] = {True: {}, False: {}}
        self._names: dict[bytes, str] = {}

    def endpoints(self, topic: str, publishing: bool) -> list[Endpoint]:
        """Return the publishers (``publishing`` is true) or subscriptions of a fully qualified topic that are known."""
        self._read_names()
        self._read_endpoints(publishing)
        return [
            Endpoint(
                self._names.get(guid, ""),
                _qos(policies),
                () if publishing else tuple(_strict(policies)),
                ros_type_name(type_name),
            )
            for guid, (name, type_name, policies) in self._found[publishing].items()
            if name == f"{_PREFIX}{topic}"
        ]

    def topics(self) -> dict[str, str]:
        """Return the fully qualified topics that have publishers, each with the ROS name of its message type."""
        self._read_endpoints(True)
        return {
            name.removeprefix(_PREFIX): ros_type_name(type_name)
            for name, type_name, _ in self._found[True].values()
            if name.startswith(f"{_PREFIX}/")
        }

    def _read_endpoints(self, publishing: bool) -> None:
        found = self._found[publishing]
        for sample in _taken(self._readers[publishing].take):
            guid = sample.key.bytes
            info = sample.sample_info
            # An endpoint that has left before it was read here still has its data.
            if info.valid_data and info.instance_state == InstanceState.Alive:
                found[guid] = sample.topic_name, sample.type_name, sample.qos
            else:
                found.pop(guid, None)
                self._names.pop(guid, None)

    def _read_names(self) -> None:
        for data in _taken(self._nodes.take):
            try:
                participant = cdr.decode(self._node_type, data)
            except ConversionError:
                continue  # written by a ROS 2 with GIDs of another size
            for node in participant.node_entities_info_seq:
                name = NodeIdentity(node.node_name, node.node_namespace).full_name
                for gid in (*node.reader_gid_seq, *node.writer_gid_seq):
                    self._names[gid.data[:16]] = name


def _taken(take: Any) -> Iterator[Any]:
    """Yield all samples that a reader has received; ``take`` is the reader's function that takes samples."""
    samples: Sequence[Any] = take(_TAKE)
    while samples:
        yield from samples
        samples = take(_TAKE)


def _qos(policies: DdsQos) -> Qos:
    reliable = policies[Policy.Reliability] != Policy.Reliability.BestEffort
    latched = policies[Policy.Durability] != Policy.Durability.Volatile
    return Qos("reliable" if reliable else "best_effort", "transient_local" if latched else "volatile")


def _strict(policies: DdsQos) -> Iterator[str]:
    """Yield the QoS policies of a reader that a writer with ROS 2's defaults does not satisfy."""
    if policies[Policy.Deadline].deadline != _INFINITE:
        yield "deadline"
    if policies[Policy.Liveliness] != Policy.Liveliness.Automatic(_INFINITE):
        yield "liveliness"
