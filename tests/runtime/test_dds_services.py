"""Parameter services over DDS, asked as a ROS 2 client with rmw_cyclonedds_cpp asks."""

from __future__ import annotations

import itertools
import logging
import struct
import threading
from collections.abc import Iterator
from functools import cache
from typing import Any, TypeVar, get_type_hints

import pytest
from needs import NO_DDS
from polling import wait_until

from generated.registry import REGISTRY
from roverlink.runtime import Qos
from roverlink.runtime.core import cdr
from roverlink.runtime.core.messages import Message
from roverlink.runtime.interfaces import rcl_interfaces as rcl
from roverlink.runtime.middleware import NodeIdentity, open_middleware
from roverlink.runtime.ros_arguments import parameters
from roverlink.runtime.ros_arguments.live_parameters import LiveParameters

pytest.importorskip("cyclonedds", reason=NO_DDS)

from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import make_idl_struct, types
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic

from roverlink.runtime.middleware.cyclone import RawReader, RawWriter
from roverlink.runtime.middleware.dds_types import dds_qos, dds_type

_NODE = NodeIdentity("udp_forwarder", "/rover")
_CLIENT = 0x0123_4567_89AB_CDEF
_HEADER = struct.Struct("<4sQq")  # CDR's header; then rmw_cyclonedds_cpp's cdds_request_header_t: guid and seq

M = TypeVar("M", bound=Message)


@pytest.fixture(autouse=True)
def _with_cyclone(monkeypatch: pytest.MonkeyPatch, domain: int) -> None:
    """On this host alone; the nodes of ROS 2 use Cyclone DDS."""
    for name in ("CYCLONEDDS_URI", "ROS_AUTOMATIC_DISCOVERY_RANGE", "ROS_DISTRO"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("ROS_LOCALHOST_ONLY", "1")
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    monkeypatch.setenv("RMW_IMPLEMENTATION", "rmw_cyclonedds_cpp")


@pytest.fixture
def live() -> LiveParameters:
    """The parameters of a bridge that can apply any change."""
    live = LiveParameters(REGISTRY, parameters.read(REGISTRY, {}), logging.getLogger("test_dds_services"))
    live.on_change(lambda _: None)
    return live


@cache
def _type_with_header(message_type: Any) -> Any:
    """Cyclone DDS checks what its Python package writes, so the DDS type has the fields of the header too."""
    plain = dds_type(message_type)
    own = {"client": types.uint64, "number": types.int64, **get_type_hints(plain, include_extras=True)}
    return make_idl_struct(plain.__name__, plain.__idl_typename__, own)


class _Client:
    """A client of one service at a time, with a participant of its own."""

    def __init__(self, domain: int) -> None:
        self._participant = DomainParticipant(domain)
        self._numbers = itertools.count(1)

    def call(self, service: str, request: Message, response: type[M]) -> M:
        """The response to a request."""
        name = f"{_NODE.full_name}/{service}"
        writer = self._writer(f"rq{name}Request", type(request))
        reader = self._reader(f"rr{name}Reply", response)
        wait_until(lambda: writer.get_matched_subscriptions() and reader.get_matched_publications(), name)
        data, number = cdr.encode(request), next(self._numbers)
        RawWriter(writer).write([_HEADER.pack(data[:4], _CLIENT, number) + data[4:]])
        taken = RawReader(reader)
        (answer,) = wait_until(lambda: taken.take(10), f"the response of {name}")
        encapsulation, *identification = _HEADER.unpack_from(answer)
        assert identification == [_CLIENT, number]
        return cdr.decode(response, encapsulation + answer[_HEADER.size :])

    def _writer(self, topic: str, message_type: type[Message]) -> DataWriter[Any]:
        made: Topic[Any] = Topic(self._participant, topic, _type_with_header(message_type))
        return DataWriter(self._participant, made, qos=dds_qos(Qos(), writing=True))

    def _reader(self, topic: str, message_type: type[Message]) -> DataReader[Any]:
        made: Topic[Any] = Topic(self._participant, topic, _type_with_header(message_type))
        return DataReader(self._participant, made, qos=dds_qos(Qos(), writing=False))


@pytest.fixture
def client(live: LiveParameters, domain: int) -> Iterator[_Client]:
    """A client, while the node is there."""
    with open_middleware("dds", _NODE, live):
        yield _Client(domain)


def _text(value: str) -> rcl.ParameterValue:
    return rcl.ParameterValue(rcl.ParameterValue.STRING, string_value=value)


def test_a_client_lists_the_parameters(client: _Client, live: LiveParameters) -> None:
    """All are listed, or those of the given names."""
    for prefixes, wanted in (([], list(live.values)), (["dst_ip", "dst"], ["dst_ip"])):
        response = client.call("list_parameters", rcl.ListParametersRequest(prefixes), rcl.ListParametersResponse)
        assert response.result.names == wanted


def test_a_client_gets_values_types_and_descriptions(client: _Client, live: LiveParameters) -> None:
    """A known parameter has all three."""
    names = ["dst_ip", "listen_port"]
    response = client.call("get_parameters", rcl.GetParametersRequest(names), rcl.GetParametersResponse)
    assert [(value.type, value.string_value, value.integer_value) for value in response.values] == [
        (4, "127.0.0.1", 0),
        (2, "", 5000),
    ]
    types = client.call("get_parameter_types", rcl.GetParameterTypesRequest(names), rcl.GetParameterTypesResponse)
    assert list(types.types) == [4, 2]
    described = client.call("describe_parameters", rcl.DescribeParametersRequest(names), rcl.DescribeParametersResponse)
    assert described.descriptors == [live.descriptors[name] for name in names]


def test_an_unknown_name_gets_an_empty_response(client: _Client) -> None:
    """As with rclpy, nothing is said of the known ones beside it."""
    names = ["dst_ip", "nonsense"]
    assert not client.call("get_parameters", rcl.GetParametersRequest(names), rcl.GetParametersResponse).values


def test_a_client_sets_parameters_one_by_one(client: _Client, live: LiveParameters) -> None:
    """Each has its own result; a wrong one does not hinder the others."""
    request = rcl.SetParametersRequest(
        [
            rcl.Parameter("forward_policy", _text("all")),
            rcl.Parameter("listen_address", _text("127.0.0.2")),
            rcl.Parameter("dst_ip", rcl.ParameterValue(rcl.ParameterValue.NOT_SET)),
        ]
    )
    results = client.call("set_parameters", request, rcl.SetParametersResponse).results
    assert [result.successful for result in results] == [True, False, False]
    assert "'listen_address' is read-only" in results[1].reason
    assert live.values["forward_policy"] == "all"


def test_a_client_sets_all_or_none(client: _Client, live: LiveParameters) -> None:
    """With one wrong value, nothing changes."""
    right, wrong = rcl.Parameter("forward_policy", _text("all")), rcl.Parameter("source_policy", _text("none"))
    for changes, successful in (([right, wrong], False), ([right], True)):
        response = client.call(
            "set_parameters_atomically",
            rcl.SetParametersAtomicallyRequest(changes),
            rcl.SetParametersAtomicallyResponse,
        )
        assert response.result.successful is successful
        assert live.values["forward_policy"] == ("all" if successful else "mapping")


def test_a_change_is_a_parameter_event(client: _Client) -> None:
    """Other nodes learn of a change on /parameter_events."""
    events: list[bytes] = []
    with open_middleware("dds", NodeIdentity("listener")) as listener:
        subscription = listener.subscribe("/parameter_events", rcl.ParameterEvent, Qos(), events.extend)
        wait_until(subscription.has_publishers, "the node's publisher")
        request = rcl.SetParametersRequest([rcl.Parameter("forward_policy", _text("all"))])
        client.call("set_parameters", request, rcl.SetParametersResponse)
        event = cdr.decode(rcl.ParameterEvent, wait_until(lambda: events, "the event")[0])
    assert event.node == "/rover/udp_forwarder"
    assert event.changed_parameters == request.parameters


def test_a_request_that_cannot_be_read_is_ignored(client: _Client, caplog: pytest.LogCaptureFixture) -> None:
    """A name that is not UTF-8 gets no response but a warning, and the next request is answered."""
    writer = client._writer(f"rq{_NODE.full_name}/get_parametersRequest", rcl.GetParametersRequest)
    wait_until(writer.get_matched_subscriptions, "the service")
    RawWriter(writer).write([bytes.fromhex("00010000") + bytes(16) + bytes.fromhex("01000000 02000000 ff00")])
    wait_until(lambda: "get_parameters ignored" in caplog.text, "the warning")
    response = client.call("get_parameters", rcl.GetParametersRequest(["dst_ip"]), rcl.GetParametersResponse)
    assert response.values == [_text("127.0.0.1")]


def test_without_cyclone_there_are_no_services(
    live: LiveParameters, domain: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A client of another middleware would wait for a response that cannot reach it."""
    monkeypatch.delenv("RMW_IMPLEMENTATION")
    with open_middleware("dds", _NODE, live):
        assert "dds-services" not in {thread.name for thread in threading.enumerate()}
