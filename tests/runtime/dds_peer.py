"""Another DDS program, which shares no code with the bridge: its types are written by hand after the .msg files.

Started by the tests as a program of its own, so that everything goes over the wire. Each line that it prints is JSON.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
import os
import time
from typing import Any

from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsPublication, BuiltinTopicDcpsSubscription
from cyclonedds.core import Policy, Qos
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.idl import make_idl_struct, types
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


_AXES = [f"{sensor}_{axis}" for sensor in ("accel", "gyro", "mag") for axis in "xyz"]
SensorState = make_idl_struct("SensorState_", "comms.msg.dds_.SensorState_", {"state": types.uint8})
ImuSensorInformation = make_idl_struct(
    "ImuSensorInformation_",
    "comms.msg.dds_.ImuSensorInformation_",
    {**dict.fromkeys(_AXES, types.float32), "is_calibrated": bool, "state": SensorState, "error_code": types.uint8},
)


def _graph_type(gid_bytes: int) -> Any:
    """rmw_dds_common/msg/ParticipantEntitiesInfo; a Gid has 24 bytes up to Humble, and 16 from Iron on."""
    package = "rmw_dds_common.msg.dds_"
    gid = make_idl_struct("Gid_", f"{package}.Gid_", {"data": types.array[types.uint8, gid_bytes]})
    names = dict.fromkeys(("node_namespace", "node_name"), types.bounded_str[256])
    gids = dict.fromkeys(("reader_gid_seq", "writer_gid_seq"), types.sequence[gid])
    node = make_idl_struct("NodeEntitiesInfo_", f"{package}.NodeEntitiesInfo_", {**names, **gids})
    fields = {"gid": gid, "node_entities_info_seq": types.sequence[node]}
    return make_idl_struct("ParticipantEntitiesInfo_", f"{package}.ParticipantEntitiesInfo_", fields)


_RELIABLE = Policy.Reliability.Reliable(0)
_PLAIN_CDR = Policy.DataRepresentation(use_cdrv0_representation=True)


def _say(**values: Any) -> None:
    print(json.dumps(values), flush=True)


def _deadline() -> float:
    return time.monotonic() + _PATIENCE_S


def _read(participant: DomainParticipant, arguments: argparse.Namespace) -> None:
    """Say each sample of a topic, as an ordinary reliable ROS 2 subscription gets it."""
    topic = Topic(participant, arguments.topic, ImuSensorInformation)
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
    topic = Topic(participant, arguments.topic, ImuSensorInformation)
    writer = DataWriter(participant, topic, Qos(_RELIABLE, Policy.History.KeepLast(10), _PLAIN_CDR))
    deadline = _deadline()
    while not writer.get_matched_subscriptions() and time.monotonic() < deadline:
        time.sleep(0.005)
    values = json.loads(arguments.sample)
    writer.write(ImuSensorInformation(**{**values, "state": SensorState(**values["state"])}))
    writer.wait_for_acks(duration(seconds=_PATIENCE_S))


def _graph(participant: DomainParticipant, arguments: argparse.Namespace) -> None:
    """Say what ros_discovery_info says of a node, and what DDS itself says of endpoints, once both are complete."""
    topic = Topic(participant, "ros_discovery_info", _graph_type(arguments.gid_bytes))
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
