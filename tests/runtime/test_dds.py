"""Real DDS on loopback: strangers whose types are written by hand, and clients of the parameter services."""

from __future__ import annotations

import contextlib
import dataclasses
import gc
import itertools
import logging
import struct
import subprocess
import sys
import threading
import weakref
from collections.abc import Callable, Iterator, Sequence
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, get_type_hints
from unittest.mock import Mock

import pytest
from asking import asking_registry
from bridge_rig import QUIET, Rig, end, of_peers
from lines import cable
from needs import NO_DDS
from polling import PATIENCE_S, wait_until

from generated.messages import DrivingBoardMotorMessage, ImuSensorInformation, SensorState
from generated.registry import REGISTRY
from roverlink.dds_domain import claim_domain
from roverlink.runtime import Qos
from roverlink.runtime.core import cdr
from roverlink.runtime.core.messages import Message
from roverlink.runtime.core.registry import EndName
from roverlink.runtime.interfaces import rcl_interfaces as rcl
from roverlink.runtime.middleware import Endpoint, Middleware, NodeIdentity, open_middleware
from roverlink.runtime.middleware.following import FollowingSubscription
from roverlink.runtime.ros_arguments import parameters
from roverlink.runtime.ros_arguments.live_parameters import LiveParameters
from roverlink.runtime.text.values import message_to_values

pytest.importorskip("cyclonedds", reason=NO_DDS)

from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsPublication, BuiltinTopicDcpsSubscription
from cyclonedds.core import Policy
from cyclonedds.core import Qos as CycloneQos
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.idl import make_idl_struct, types
from cyclonedds.idl._xt_builder import XTBuilder
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic

from roverlink.runtime.middleware.cyclone import RawReader, RawWriter, describe
from roverlink.runtime.middleware.dds_types import dds_qos, idl_struct

_SAMPLE = ImuSensorInformation(
    *[number / 4 for number in range(1, 10)], is_calibrated=True, state=SensorState(3), error_code=8
)
_ROOT = Path(__file__).parents[2]

# A stranger's types, written by hand after the .msg files.
_AXES = [f"{sensor}_{axis}" for sensor in ("accel", "gyro", "mag") for axis in "xyz"]
_StateOfStrangers = make_idl_struct("SensorState_", "comms.msg.dds_.SensorState_", {"state": types.uint8})
_ImuOfStrangers = make_idl_struct(
    "ImuSensorInformation_",
    "comms.msg.dds_.ImuSensorInformation_",
    {**dict.fromkeys(_AXES, types.float32), "is_calibrated": bool, "state": _StateOfStrangers}
    | {"error_code": types.uint8},
)

M = TypeVar("M", bound=Message)
Open = Callable[..., Middleware]


@pytest.fixture(autouse=True)
def _alone_on_loopback(monkeypatch: pytest.MonkeyPatch, domain: int) -> None:
    """Stay on this host, in a domain of our own."""
    for name in ("CYCLONEDDS_URI", "ROS_AUTOMATIC_DISCOVERY_RANGE", "ROS_DISTRO", "RMW_IMPLEMENTATION"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("ROS_LOCALHOST_ONLY", "1")
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))


@pytest.fixture
def join() -> Iterator[Open]:
    """Joins the domain as a node; leaves it at the end."""
    with contextlib.ExitStack() as joined:

        def open_one(name: str = "udp_forwarder", namespace: str = "/") -> Middleware:
            return joined.enter_context(open_middleware("dds", NodeIdentity(name, namespace)))

        yield open_one


@pytest.fixture
def topic(request: pytest.FixtureRequest) -> str:
    """A topic that no other test has."""
    name: str = "/" + "".join(c if c.isalnum() else "_" for c in request.node.name)
    return name


def _of_strangers(*policies: Any, depth: int = 10) -> CycloneQos:
    """Return the QoS of an ordinary ROS 2 endpoint, with policies of its own."""
    plain_cdr = Policy.DataRepresentation(use_cdrv0_representation=True)
    return CycloneQos(Policy.Reliability.Reliable(0), Policy.History.KeepLast(depth), plain_cdr, *policies)


def _gathered(middleware: Middleware, topic: str, message_type: Any = ImuSensorInformation, **qos: Any) -> list[bytes]:
    """What comes in on a topic from now on."""
    seen: list[bytes] = []
    middleware.subscribe(topic, message_type, Qos(**qos), seen.extend)
    return seen


def _numbered(count: int) -> list[bytes]:
    return [cdr.encode(ImuSensorInformation(accel_x=float(number))) for number in range(count)]


def _numbers(messages: Sequence[bytes]) -> list[float]:
    return [cdr.decode(ImuSensorInformation, data).accel_x for data in messages]


# --- the graph --------------------------------------------------------------------------------------------------


def test_endpoints_and_topics_are_listed_until_they_leave(join: Open, topic: str) -> None:
    """An endpoint with node and QoS, a topic with its type while it has a publisher; one only read is not listed."""
    ours, other, back = join(), join("joystick", "/base"), f"{topic}_back"
    qos = Qos(reliability="best_effort", durability="transient_local")
    other.publisher(topic, ImuSensorInformation, qos)
    _gathered(other, back)
    wait_until(lambda: ours.endpoints(topic, True) == [Endpoint("/base/joystick", qos)], "the publisher")
    wait_until(lambda: ours.endpoints(back, False) == [Endpoint("/base/joystick", Qos())], "the subscription")
    assert (ours.endpoints(topic, False), ours.endpoints(back, True)) == ([], [])
    wait_until(lambda: ours.topics().get(topic) == "comms/msg/ImuSensorInformation", "the topic")
    assert back not in ours.topics()
    other.close()
    wait_until(lambda: not ours.endpoints(topic, True) and topic not in ours.topics(), "the publisher to leave")


# --- the wire ---------------------------------------------------------------------------------------------------


def test_a_stranger_reads_what_we_publish(join: Open, topic: str, domain: int) -> None:
    """A plain DDS reader of the ROS 2 type, which has no node, gets our messages field by field."""
    ours, still, seen = join(), ImuSensorInformation(accel_z=-9.75), list[Any]()
    publisher = ours.publisher(topic, ImuSensorInformation, Qos())
    participant = DomainParticipant(domain)
    reader = DataReader(participant, Topic(participant, f"rt{topic}", _ImuOfStrangers), _of_strangers())
    wait_until(publisher.has_subscribers, "the stranger's reader")
    wait_until(lambda: ours.endpoints(topic, False) == [Endpoint("", Qos())], "the reader without a name")
    assert publisher.publish([cdr.encode(_SAMPLE), cdr.encode(still)]) == 2
    wait_until(lambda: seen.extend(reader.take(2)) or len(seen) == 2, "both messages")
    assert [dataclasses.asdict(sample) for sample in seen] == [message_to_values(_SAMPLE), message_to_values(still)]


def test_we_read_what_a_stranger_publishes(join: Open, topic: str, domain: int) -> None:
    """A plain DDS writer's samples come in as plain CDR of the ROS 2 message, and its end is no message."""
    middleware = join()
    seen = _gathered(middleware, topic)
    participant = DomainParticipant(domain)
    writer = DataWriter(participant, Topic(participant, f"rt{topic}", _ImuOfStrangers), _of_strangers())
    wait_until(writer.get_matched_subscriptions, "our reader")
    values = message_to_values(_SAMPLE)
    writer.write(_ImuOfStrangers(**{**values, "state": _StateOfStrangers(**values["state"])}))
    wait_until(lambda: seen, "the sample")
    assert seen[0].startswith(cdr.LITTLE_ENDIAN)
    del writer, participant
    wait_until(lambda: not middleware.endpoints(topic, True), "the writer to leave")  # it says something when it goes
    publisher = middleware.publisher(topic, ImuSensorInformation, Qos())
    wait_until(publisher.has_subscribers, "our own reader")
    publisher.publish([cdr.encode(ImuSensorInformation())])
    wait_until(lambda: len(seen) > 1, "our own message")
    assert [cdr.decode(ImuSensorInformation, data) for data in seen] == [_SAMPLE, ImuSensorInformation()]


# --- quality of service -----------------------------------------------------------------------------------------

_BEST_EFFORT = {"reliability": "best_effort", "depth": 5}
_LATCHED = {"durability": "transient_local", "depth": 2}


@pytest.mark.parametrize(
    ("written", "refused", "accepted"),
    [(_BEST_EFFORT, {}, _BEST_EFFORT), ({}, _LATCHED, _BEST_EFFORT), ({}, _LATCHED, {"history": "keep_all"})],
    ids=["reliable reader, best-effort writer", "latched reader, volatile writer", "any history"],
)
def test_qualities_of_service_match_as_ros_2_has_them(
    join: Open, topic: str, written: Any, refused: Any, accepted: Any
) -> None:
    """A reader that asks for more than the writer offers does not match; one that asks for the same or less does."""
    listener = join("listener")
    refused_seen, accepted_seen = _gathered(listener, topic, **refused), _gathered(listener, topic, **accepted)
    publisher = join("talker").publisher(topic, ImuSensorInformation, Qos(**written))
    wait_until(publisher.has_subscribers, "the reader that matches")  # the other one was announced before it
    publisher.publish([cdr.encode(_SAMPLE)])
    wait_until(lambda: accepted_seen, "the message")
    assert not refused_seen


def test_a_type_whose_compilation_was_interrupted_is_compiled_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """What the package keeps of the first attempt is not taken for the result."""
    kind, whole = (make_idl_struct("Kind_", "comms.msg.dds_.Kind_", {"state": types.uint8}) for _ in range(2))
    with monkeypatch.context() as patch:
        patch.setattr(XTBuilder, "process_type", lambda _: [Mock(**{"serialize.side_effect": KeyboardInterrupt})])
        with pytest.raises(KeyboardInterrupt):
            describe(kind)
    assert describe(kind) == describe(whole)


# --- being a node -----------------------------------------------------------------------------------------------


def _graph_type(gid_bytes: int) -> Any:
    """Return the type of ros_discovery_info; a Gid has 24 bytes up to Humble, and 16 from Iron on."""
    package = "rmw_dds_common.msg.dds_"
    gid = make_idl_struct("Gid_", f"{package}.Gid_", {"data": types.array[types.uint8, gid_bytes]})
    names = dict.fromkeys(("node_namespace", "node_name"), types.bounded_str[256])
    gids = dict.fromkeys(("reader_gid_seq", "writer_gid_seq"), types.sequence[gid])
    node = make_idl_struct("NodeEntitiesInfo_", f"{package}.NodeEntitiesInfo_", {**names, **gids})
    fields = {"gid": gid, "node_entities_info_seq": types.sequence[node]}
    return make_idl_struct("ParticipantEntitiesInfo_", f"{package}.ParticipantEntitiesInfo_", fields)


@pytest.mark.parametrize(("distribution", "gid_bytes"), [(None, 24), ("jazzy", 16)])
def test_we_are_seen_as_a_node_with_our_endpoints(
    join: Open, topic: str, domain: int, monkeypatch: pytest.MonkeyPatch, distribution: str | None, gid_bytes: int
) -> None:
    """ros_discovery_info has node, namespace and the GIDs of each reader and writer, as long as ROS 2 has them."""
    if distribution is not None:
        monkeypatch.setenv("ROS_DISTRO", distribution)
    ours = join("udp_forwarder", "/rover")
    for number in range(2):
        ours.publisher(f"{topic}/out{number}", ImuSensorInformation, Qos())
    _gathered(ours, f"{topic}/in")
    participant = DomainParticipant(domain)
    latched = _of_strangers(Policy.Durability.TransientLocal, depth=1)
    graph = DataReader(participant, Topic(participant, "ros_discovery_info", _graph_type(gid_bytes)), latched)
    kinds = (BuiltinTopicDcpsPublication, BuiltinTopicDcpsSubscription)
    discovered = [BuiltinDataReader(participant, kind) for kind in kinds]
    endpoints: dict[str, Any] = {}

    def complete() -> list[Any]:
        found = [one for reader in discovered for one in reader.take(100)]
        endpoints.update({one.topic_name: one for one in found if one.topic_name.startswith(f"rt{topic}")})
        nodes = [node for sample in graph.read(100) for node in sample.node_entities_info_seq]
        gids = [gid for node in nodes for gid in (*node.reader_gid_seq, *node.writer_gid_seq)]
        return nodes if len(gids) == len(endpoints) == 3 else []

    (node,) = wait_until(complete, "the node with all endpoints")
    gids = {name: one.key.bytes.ljust(gid_bytes, b"\0") for name, one in endpoints.items()}
    assert (node.node_namespace, node.node_name) == ("/rover", "udp_forwarder")
    assert [bytes(gid.data) for gid in node.reader_gid_seq] == [gids[f"rt{topic}/in"]]
    assert [bytes(gid.data) for gid in node.writer_gid_seq] == [gids[f"rt{topic}/out{number}"] for number in range(2)]
    for one in endpoints.values():
        assert one.type_name == "comms::msg::dds_::ImuSensorInformation_"
        # as rmw_dds_common writes it
        assert one.qos[Policy.Userdata].data.decode() == f"typehash={ImuSensorInformation.__typehash__};"


def test_a_publisher_of_a_node_that_has_left_accepts_nothing(topic: str) -> None:
    """What is published after the node has gone is not taken for published, and is no error."""
    with open_middleware("dds", NodeIdentity("node")) as middleware:
        publisher = middleware.publisher(topic, ImuSensorInformation, Qos())
        assert publisher.publish([cdr.encode(_SAMPLE)]) == 1
    middleware.close()
    assert publisher.publish([cdr.encode(_SAMPLE)]) == 0


def test_an_exact_depth_is_kept_while_we_are_busy(join: Open, topic: str) -> None:
    """Of many large messages that wait, only the newest ones are kept."""
    ours, publisher = join(), join("other").publisher(topic, ImuSensorInformation, Qos("best_effort"))
    seen: list[bytes] = []
    busy, go_on = threading.Event(), threading.Event()

    def take(messages: Sequence[bytes]) -> None:
        seen.extend(messages)
        busy.set()
        go_on.wait(PATIENCE_S)

    ours.subscribe(topic, ImuSensorInformation, Qos("best_effort", depth=3), take, exact_depth=True)
    samples = [cdr.encode(ImuSensorInformation(error_code=number)) for number in range(100)]

    def first() -> bool:
        publisher.publish(samples[:1])
        return busy.is_set()

    wait_until(first, "a message")
    marks = _gathered(join("third"), topic, reliability="best_effort")

    def all_came() -> bool:
        publisher.publish(samples)
        return samples[-1] in {mark[: len(samples[-1])] for mark in marks}

    wait_until(all_came, "the messages")
    before = len(seen)
    go_on.set()
    wait_until(lambda: len(seen) > before, "what was kept")
    assert [cdr.decode(ImuSensorInformation, one).error_code for one in seen[before:]] == [97, 98, 99]


def test_a_subscription_follows_its_publishers(join: Open, topic: str) -> None:
    """It is reliable with a reliable publisher; if another one takes its place, it takes over type and QoS."""
    ours, seen = join(), list[type[Message]]()
    types = (ImuSensorInformation, DrivingBoardMotorMessage)
    following = FollowingSubscription(ours, topic, types, lambda kind, _: seen.append(kind), depth=5)
    assert not following.look()
    for message_type, qos in (
        (ImuSensorInformation, Qos("best_effort")),
        (ImuSensorInformation, Qos("reliable", "transient_local")),
        (DrivingBoardMotorMessage, Qos("reliable")),
    ):
        node = join("camera")
        publisher = node.publisher(topic, message_type, qos)
        wait_until(lambda: ours.topics().get(topic) == message_type.__msgtype__, "the publisher")  # noqa: B023

        def heard() -> bool:
            following.look()
            publisher.publish([cdr.encode(message_type())])  # noqa: B023
            return message_type in seen  # noqa: B023  # a late one of the last publisher may come before

        wait_until(heard, "a message of this publisher")
        wait_until(lambda: [one.qos for one in node.endpoints(topic, False)] == [qos], "the QoS")  # noqa: B023
        node.close()
        wait_until(lambda: topic not in ours.topics(), "the publisher to leave")
        seen.clear()


def test_a_subscription_tells_that_its_last_publisher_has_left(join: Open, topic: str) -> None:
    """The deadman need not ask for it."""
    left, node = threading.Event(), join("drive")
    subscription = join().subscribe(topic, ImuSensorInformation, Qos(), Mock())
    subscription.watch(left.set)  # type: ignore[attr-defined]  # over DDS
    node.publisher(topic, ImuSensorInformation, Qos())
    wait_until(subscription.has_publishers, "the publisher")
    node.close()
    assert left.wait(PATIENCE_S)


@pytest.mark.slow
def test_a_node_that_cannot_leave_is_kept(join: Open, topic: str) -> None:
    """Cyclone DDS goes on to tell it of publishers, so Python must not free it, even after its thread has gone on."""
    publisher, hangs, go_on = join().publisher(topic, ImuSensorInformation, Qos()), threading.Event(), threading.Event()

    def take(_: Sequence[bytes]) -> None:
        hangs.set()
        go_on.wait(PATIENCE_S)

    before = {*threading.enumerate()}
    node = open_middleware("dds", NodeIdentity("hangs"))
    [thread] = [one for one in threading.enumerate() if one.name == "dds-take" and one not in before]
    node.subscribe(topic, ImuSensorInformation, Qos(), take)
    wait_until(lambda: publisher.publish(_numbered(1)) and hangs.is_set(), "a message")
    node.close()
    kept = weakref.ref(node)
    del node
    go_on.set()
    thread.join(PATIENCE_S)
    gc.collect()
    assert kept() is not None


# --- the environment --------------------------------------------------------------------------------------------


_ALONE = """
import os, sys, time
os.environ.update({environment!r})
from generated.messages import ImuSensorInformation
from roverlink.runtime import MiddlewareError, Qos
from roverlink.runtime.middleware import NodeIdentity, open_middleware

try:
    with open_middleware("dds", NodeIdentity("alone")) as middleware:
        publisher = middleware.publisher("/alone", ImuSensorInformation, Qos())
        deadline = time.monotonic() + {patience_s}
        while not publisher.has_subscribers() and time.monotonic() < deadline:
            time.sleep(0.01)
        print("matched" if publisher.has_subscribers() else "nobody")
except MiddlewareError as error:
    print("refused:", error)
"""
_OWN_CONFIGURATION = (
    '<CycloneDDS><Domain><General><Interfaces><NetworkInterface address="127.0.0.1"/></Interfaces></General>'
    '<Discovery><ParticipantIndex>auto</ParticipantIndex><Peers><Peer address="localhost"/></Peers></Discovery>'
    "</Domain></CycloneDDS>"
)
_BROKEN_CONFIGURATION = "<CycloneDDS><Nonsense/></CycloneDDS>"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("environment", "said"),
    [
        ({"ROS_LOCALHOST_ONLY": "1"}, "matched"),
        ({"ROS_LOCALHOST_ONLY": "0", "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}, "matched"),
        ({"ROS_LOCALHOST_ONLY": "1", "CYCLONEDDS_URI": _OWN_CONFIGURATION}, "matched"),
        ({"CYCLONEDDS_URI": _BROKEN_CONFIGURATION}, "refused: Cyclone DDS cannot join domain {domain}: "),
    ],
    ids=["localhost only", "discovery range", "own configuration", "broken configuration"],
)
def test_each_way_to_stay_on_this_host_finds_the_others(
    join: Open, domain: int, environment: dict[str, str], said: str
) -> None:
    """ROS 2's variables, old and new, and a configuration of the user's own, which is an error where it is broken."""
    _gathered(join(), "/alone")
    script = [sys.executable, "-c", _ALONE.format(environment=environment, patience_s=PATIENCE_S)]
    done = subprocess.run(script, capture_output=True, text=True, cwd=_ROOT, timeout=3 * PATIENCE_S)
    assert done.stdout.startswith(said.format(domain=domain)), done.stderr


def test_a_program_that_is_in_the_domain_already_can_join_as_a_node(
    topic: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A program with DDS entities of its own may run a bridge as well: the domain stays as it configured it."""
    with contextlib.ExitStack() as held:
        other_domain = claim_domain(held)  # not `domain`, which this process has configured
        domain = Domain(other_domain, _OWN_CONFIGURATION)
        participant = DomainParticipant(other_domain)
        monkeypatch.setenv("ROS_DOMAIN_ID", str(other_domain))
        with open_middleware("dds", NodeIdentity("node")) as middleware:
            assert middleware.publisher(topic, ImuSensorInformation, Qos()).publish([cdr.encode(_SAMPLE)]) == 1
        del participant, domain


def test_the_last_node_to_leave_gives_back_the_domain(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """While one is in it, the domain keeps its configuration; after the last has left, a node brings its own."""
    said = []
    with contextlib.ExitStack() as joined:
        joined.enter_context(open_middleware("dds", NodeIdentity("first")))
        monkeypatch.setenv("CYCLONEDDS_URI", _OWN_CONFIGURATION.replace("auto", "none"))
        for name in ("second", "third"):
            joined.enter_context(open_middleware("dds", NodeIdentity(name)))
            said.append("keeps its configuration" in caplog.text)
            joined.close()
            caplog.clear()
    assert said == [True, False]


def test_a_process_claims_another_domain_each_time() -> None:
    """Entities of a domain that was given back may still exist, with its configuration."""
    numbers = set[int]()
    for _ in range(3):
        with contextlib.ExitStack() as held:
            numbers.add(claim_domain(held))
    assert len(numbers) == 3


# --- parameter services, asked as a ROS 2 client with rmw_cyclonedds_cpp asks ------------------------------------

_NODE = NodeIdentity("udp_forwarder", "/rover")
_CLIENT = 0x0123_4567_89AB_CDEF
_HEADER = struct.Struct("<4sQq")  # CDR's header; then rmw_cyclonedds_cpp's cdds_request_header_t: guid and seq


@pytest.fixture
def live() -> LiveParameters:
    """The parameters of a bridge that can apply any change."""
    live = LiveParameters(REGISTRY, parameters.read(REGISTRY, {}), logging.getLogger("test_dds"))
    live.on_change(lambda _: None)
    return live


@cache
def _type_with_header(message_type: Any) -> Any:
    """Cyclone DDS checks what its Python package writes, so the DDS type has the fields of the header too."""
    plain = idl_struct(message_type)
    own = {"client": types.uint64, "number": types.int64, **get_type_hints(plain, include_extras=True)}
    return make_idl_struct(plain.__name__, plain.__idl_typename__, own)


class _Client:
    """A client of one service at a time, with a participant of its own."""

    def __init__(self, domain: int) -> None:
        self._participant = DomainParticipant(domain)
        self._numbers = itertools.count(1)

    def call(self, name: str, response: type[M], *arguments: Any) -> M:
        """The response to a request with these arguments."""
        request = getattr(rcl, response.__name__.replace("Response", "Request"))(*arguments)
        writer = self.writer(name, type(request))
        reader: Any = DataReader(
            self._participant, self._topic(f"rr{_NODE.full_name}/{name}Reply", response), dds_qos(Qos(), writing=False)
        )
        wait_until(lambda: writer.get_matched_subscriptions() and reader.get_matched_publications(), name)
        data, number = cdr.encode(request), next(self._numbers)
        RawWriter(writer).write([_HEADER.pack(data[:4], _CLIENT, number) + data[4:]])
        taken = RawReader(reader)
        (answer,) = wait_until(lambda: taken.take(10), f"the response of {name}")
        encapsulation, *identification = _HEADER.unpack_from(answer)
        assert identification == [_CLIENT, number]
        return cdr.decode(response, encapsulation + answer[_HEADER.size :])

    def writer(self, name: str, message_type: type[Message]) -> DataWriter[Any]:
        """A writer of the requests of a service."""
        topic = self._topic(f"rq{_NODE.full_name}/{name}Request", message_type)
        return DataWriter(self._participant, topic, dds_qos(Qos(), writing=True))

    def _topic(self, name: str, message_type: type[Message]) -> Topic[Any]:
        return Topic(self._participant, name, _type_with_header(message_type))


@pytest.fixture
def client(live: LiveParameters, domain: int, monkeypatch: pytest.MonkeyPatch) -> Iterator[_Client]:
    """A client, while the node is there; the nodes of ROS 2 use Cyclone DDS."""
    monkeypatch.setenv("RMW_IMPLEMENTATION", "rmw_cyclonedds_cpp")
    with open_middleware("dds", _NODE, live):
        yield _Client(domain)


def _text(value: str) -> rcl.ParameterValue:
    return rcl.ParameterValue(rcl.ParameterValue.STRING, string_value=value)


def test_a_client_lists_and_gets_parameters(client: _Client, live: LiveParameters) -> None:
    """All are listed, or those of the given names; a known parameter has value, type and description."""
    for prefixes, wanted in (([], list(live.values)), (["dst_ip", "dst"], ["dst_ip"])):
        assert client.call("list_parameters", rcl.ListParametersResponse, prefixes).result.names == wanted
    names = ["dst_ip", "listen_port"]
    values = client.call("get_parameters", rcl.GetParametersResponse, names).values
    assert [(value.type, value.string_value, value.integer_value) for value in values] == [
        (4, "127.0.0.1", 0),
        (2, "", 5000),
    ]
    assert list(client.call("get_parameter_types", rcl.GetParameterTypesResponse, names).types) == [4, 2]
    described = client.call("describe_parameters", rcl.DescribeParametersResponse, names)
    assert described.descriptors == [live.descriptors[name] for name in names]
    # As with rclpy, an unknown name gets an empty response: nothing is said of the known ones beside it.
    assert not client.call("get_parameters", rcl.GetParametersResponse, ["dst_ip", "nonsense"]).values


def test_a_client_sets_parameters_one_by_one_or_all_or_none(client: _Client, live: LiveParameters) -> None:
    """Each has its own result and does not hinder the others; atomically, nothing changes with one wrong value."""
    right, wrong = rcl.Parameter("forward_policy", _text("all")), rcl.Parameter("listen_address", _text("127.0.0.2"))
    for changes, successful in (([right, wrong], False), ([right], True)):
        response = client.call("set_parameters_atomically", rcl.SetParametersAtomicallyResponse, changes)
        assert response.result.successful is successful
        assert live.values["forward_policy"] == ("all" if successful else "mapping")
    unset = rcl.Parameter("dst_ip", rcl.ParameterValue(rcl.ParameterValue.NOT_SET))
    right.value = _text("mapping")
    results = client.call("set_parameters", rcl.SetParametersResponse, [right, wrong, unset]).results
    assert [result.successful for result in results] == [True, False, False]
    assert "'listen_address' is read-only" in results[1].reason
    assert live.values["forward_policy"] == "mapping"


def test_a_change_is_a_parameter_event(client: _Client) -> None:
    """Other nodes learn of a change on /parameter_events."""
    change = [rcl.Parameter("forward_policy", _text("all"))]
    events: list[bytes] = []
    with open_middleware("dds", NodeIdentity("listener")) as listener:
        subscription = listener.subscribe("/parameter_events", rcl.ParameterEvent, Qos(), events.extend)
        wait_until(subscription.has_publishers, "the node's publisher")
        client.call("set_parameters", rcl.SetParametersResponse, change)
        event = cdr.decode(rcl.ParameterEvent, wait_until(lambda: events, "the event")[0])
    assert (event.node, event.changed_parameters) == ("/rover/udp_forwarder", change)


def test_a_service_moves_an_end_to_a_line(domain: int, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Commands go over the line from then on; a wrong line is refused with the reason, and changes nothing."""
    monkeypatch.setenv("RMW_IMPLEMENTATION", "rmw_cyclonedds_cpp")
    registry = of_peers(QUIET, hardware=end("hw", "127.0.0.1"))
    with cable(tmp_path / "tty") as plugged, Rig(registry) as rig, open_middleware("dds", _NODE, rig.live):
        lines = [rcl.Parameter("hw_host", _text(f"serial:{tmp_path}/tty{more}")) for more in ("", "?baud=no")]
        results = _Client(domain).call("set_parameters", rcl.SetParametersResponse, lines).results
        assert [result.successful for result in results] == [True, False]
        assert "'no' is no value of the option 'baud'" in results[1].reason
        wait_until(lambda: rig.bridge.link_states()[EndName("hardware")].state == "ok", "a connection")
        assert rig.publish("drive_motor") == plugged.receive()


def test_a_request_that_cannot_be_read_is_ignored(client: _Client, caplog: pytest.LogCaptureFixture) -> None:
    """A name that is not UTF-8 gets no response but a warning, and the next request is answered."""
    writer = client.writer("get_parameters", rcl.GetParametersRequest)
    wait_until(writer.get_matched_subscriptions, "the service")
    RawWriter(writer).write([bytes.fromhex("00010000") + bytes(16) + bytes.fromhex("01000000 02000000 ff00")])
    wait_until(lambda: "get_parameters ignored" in caplog.text, "the warning")
    assert client.call("get_parameters", rcl.GetParametersResponse, ["dst_ip"]).values == [_text("127.0.0.1")]


@pytest.mark.slow
def test_a_service_answers_later_and_each_client_gets_its_own(join: Open, monkeypatch: pytest.MonkeyPatch) -> None:
    """A response comes from any thread, in any order, to the call that it belongs to; without a node, none is sent."""
    monkeypatch.setenv("RMW_IMPLEMENTATION", "rmw_cyclonedds_cpp")
    service = asking_registry().by_name["grip"].route.request.service
    asked: dict[float, Callable[[bytes], None]] = {}
    clients = [join(name).client("/grip", service) for name in ("one", "other")]
    heard: list[list[float]] = [[], []]

    def call(index: int, force: float) -> bool:
        def done(data: bytes) -> None:
            heard[index].append(cdr.decode(service.response, data).force)

        return bool(clients[index].call(cdr.encode(service.request(force=force)), done))

    assert not call(0, 1.0)
    join("server").offer(
        "/grip", service, lambda data, respond: asked.update({cdr.decode(service.request, data).force: respond})
    )
    for index in (0, 1):
        wait_until(lambda index=index: call(index, index), "the service")  # type: ignore[misc]
        assert call(index, index + 2)
    wait_until(lambda: len(asked) == 4, "four requests")
    for force in (3.0, 0.0, 2.0, 1.0):
        asked[force](cdr.encode(service.response(force=force * 10)))
    wait_until(lambda: heard == [[0, 20], [30, 10]], f"the responses, but {heard}")


def test_a_service_without_clients_that_get_a_response_is_not_offered(
    join: Open, caplog: pytest.LogCaptureFixture
) -> None:
    """Fast DDS clients would wait for ever, so there is a warning instead, with what to do."""
    service = asking_registry().by_name["grip"].route.request.service
    join("server").offer("/grip", service, lambda *_: None)
    assert "the service /grip is not offered" in caplog.text
    assert "use --middleware rclpy" in caplog.text
