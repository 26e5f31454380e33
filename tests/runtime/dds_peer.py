"""Another DDS program, which shares no code with the bridge: its types are written by hand after the .msg files.

Started by the tests as a program of its own, so that everything goes over the wire. Each line that it prints is JSON.
"""

# No `from __future__ import annotations`: cyclonedds reads the annotations as they stand.

import argparse
import dataclasses
import json
import os
import time
from dataclasses import dataclass
from typing import Any

from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsPublication, BuiltinTopicDcpsSubscription
from cyclonedds.core import Policy, Qos
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.idl import IdlStruct, types
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

_LOOPBACK = (
    '<CycloneDDS><Domain><General><Interfaces><NetworkInterface address="127.0.0.1"/></Interfaces></General>'
    '<Discovery><ParticipantIndex>auto</ParticipantIndex><Peers><Peer address="localhost"/></Peers></Discovery>'
    "</Domain></CycloneDDS>"
)
_PATIENCE_S = 30.0


@dataclass
class SensorState_(IdlStruct, typename="comms.msg.dds_.SensorState_"):  # noqa: N801  # as ROS 2's IDL has it
    """comms/msg/SensorState."""

    state: types.uint8 = 0


@dataclass
class ImuSensorInformation_(IdlStruct, typename="comms.msg.dds_.ImuSensorInformation_"):  # noqa: N801
    """comms/msg/ImuSensorInformation."""

    accel_x: types.float32 = 0.0
    accel_y: types.float32 = 0.0
    accel_z: types.float32 = 0.0
    gyro_x: types.float32 = 0.0
    gyro_y: types.float32 = 0.0
    gyro_z: types.float32 = 0.0
    mag_x: types.float32 = 0.0
    mag_y: types.float32 = 0.0
    mag_z: types.float32 = 0.0
    is_calibrated: bool = False
    state: SensorState_ = dataclasses.field(default_factory=SensorState_)
    error_code: types.uint8 = 0


@dataclass
class Gid24(IdlStruct, typename="rmw_dds_common.msg.dds_.Gid_"):
    """rmw_dds_common/msg/Gid up to Humble."""

    data: types.array[types.uint8, 24]


@dataclass
class Gid16(IdlStruct, typename="rmw_dds_common.msg.dds_.Gid_"):
    """rmw_dds_common/msg/Gid from Iron on."""

    data: types.array[types.uint8, 16]


@dataclass
class Node24(IdlStruct, typename="rmw_dds_common.msg.dds_.NodeEntitiesInfo_"):
    """rmw_dds_common/msg/NodeEntitiesInfo up to Humble."""

    node_namespace: types.bounded_str[256]
    node_name: types.bounded_str[256]
    reader_gid_seq: types.sequence[Gid24]
    writer_gid_seq: types.sequence[Gid24]


@dataclass
class Node16(IdlStruct, typename="rmw_dds_common.msg.dds_.NodeEntitiesInfo_"):
    """rmw_dds_common/msg/NodeEntitiesInfo from Iron on."""

    node_namespace: types.bounded_str[256]
    node_name: types.bounded_str[256]
    reader_gid_seq: types.sequence[Gid16]
    writer_gid_seq: types.sequence[Gid16]


@dataclass
class Graph24(IdlStruct, typename="rmw_dds_common.msg.dds_.ParticipantEntitiesInfo_"):
    """rmw_dds_common/msg/ParticipantEntitiesInfo up to Humble."""

    gid: Gid24
    node_entities_info_seq: types.sequence[Node24]


@dataclass
class Graph16(IdlStruct, typename="rmw_dds_common.msg.dds_.ParticipantEntitiesInfo_"):
    """rmw_dds_common/msg/ParticipantEntitiesInfo from Iron on."""

    gid: Gid16
    node_entities_info_seq: types.sequence[Node16]


_RELIABLE = Policy.Reliability.Reliable(0)
_PLAIN_CDR = Policy.DataRepresentation(use_cdrv0_representation=True)


def _say(**values: Any) -> None:
    print(json.dumps(values), flush=True)


def _deadline() -> float:
    return time.monotonic() + _PATIENCE_S


def _read(participant: DomainParticipant, arguments: argparse.Namespace) -> None:
    """Say each sample of a topic, as an ordinary reliable ROS 2 subscription gets it."""
    topic = Topic(participant, arguments.topic, ImuSensorInformation_)
    reader = DataReader(participant, topic, Qos(_RELIABLE, Policy.History.KeepLast(10), _PLAIN_CDR))
    _say(ready=True)
    left, deadline = arguments.count, _deadline()
    while left and time.monotonic() < deadline:
        for sample in reader.take(left):
            _say(**dataclasses.asdict(sample))
            left -= 1
        time.sleep(0.005)


def _write(participant: DomainParticipant, arguments: argparse.Namespace) -> None:
    """Write one sample to the first reader that matches, as an ordinary ROS 2 publisher does, and go."""
    topic = Topic(participant, arguments.topic, ImuSensorInformation_)
    writer = DataWriter(participant, topic, Qos(_RELIABLE, Policy.History.KeepLast(10), _PLAIN_CDR))
    deadline = _deadline()
    while not writer.get_matched_subscriptions() and time.monotonic() < deadline:
        time.sleep(0.005)
    values = json.loads(arguments.sample)
    writer.write(ImuSensorInformation_(**{**values, "state": SensorState_(**values["state"])}))
    writer.wait_for_acks(duration(seconds=_PATIENCE_S))


def _graph(participant: DomainParticipant, arguments: argparse.Namespace) -> None:
    """Say what ros_discovery_info says of a node, and what DDS itself says of endpoints, once both are complete."""
    types_of_size: dict[int, Any] = {24: Graph24, 16: Graph16}
    topic = Topic(participant, "ros_discovery_info", types_of_size[arguments.gid_bytes])
    qos = Qos(_RELIABLE, Policy.Durability.TransientLocal, Policy.History.KeepLast(1), _PLAIN_CDR)
    reader = DataReader(participant, topic, qos)
    publications = BuiltinDataReader(participant, BuiltinTopicDcpsPublication)
    subscriptions = BuiltinDataReader(participant, BuiltinTopicDcpsSubscription)
    deadline = _deadline()
    endpoints: dict[str, str] = {}
    type_names = set()
    user_data = set()
    while time.monotonic() < deadline:
        for builtin in (publications, subscriptions):
            for endpoint in builtin.take(100):
                if endpoint.topic_name.startswith("rt/"):
                    endpoints[endpoint.topic_name] = endpoint.key.bytes.hex()
                    type_names.add(endpoint.type_name)
                    user_data.add(endpoint.qos[Policy.Userdata].data.decode())
        for sample in reader.read(100):
            for node in sample.node_entities_info_seq:
                gids = [*node.reader_gid_seq, *node.writer_gid_seq]
                if node.node_name == arguments.node and len(gids) == len(endpoints) == arguments.count:
                    _say(
                        namespace=node.node_namespace,
                        readers=[bytes(gid.data).hex() for gid in node.reader_gid_seq],
                        writers=[bytes(gid.data).hex() for gid in node.writer_gid_seq],
                        endpoints=endpoints,
                        type_names=sorted(type_names),
                        user_data=sorted(user_data),
                    )
                    return
        time.sleep(0.005)


def main() -> None:
    """Do one thing."""
    parser = argparse.ArgumentParser()
    parser.add_argument("what", choices=["read", "write", "graph"])
    parser.add_argument("--topic")
    parser.add_argument("--count", type=int, default=1)
    parser.add_argument("--sample")
    parser.add_argument("--node")
    parser.add_argument("--gid-bytes", type=int, default=24)
    arguments = parser.parse_args()
    domain_id = int(os.environ["ROS_DOMAIN_ID"])
    domain = Domain(domain_id, _LOOPBACK)
    participant = DomainParticipant(domain_id)
    {"read": _read, "write": _write, "graph": _graph}[arguments.what](participant, arguments)
    del domain


if __name__ == "__main__":
    main()
