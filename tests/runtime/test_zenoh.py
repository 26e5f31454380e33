"""Real zenoh through a router on loopback, with strangers that know rmw_zenoh's conventions, and zenoh's own API."""

from __future__ import annotations

import json
import logging
import signal
import struct
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from itertools import count
from typing import Any
from unittest.mock import ANY

import numpy
import pytest
from bridge_rig import Rig, envelope
from needs import NO_ZENOH, NO_ZENOH_JUDGES
from polling import PATIENCE_S, wait_until
from programs import Start

from generated.messages import DrivingBoardMotorMessage, ImuSensorInformation
from generated.registry import REGISTRY
from roverlink import standard_types
from roverlink.runtime import MiddlewareError, Qos
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import RowService
from roverlink.runtime.interfaces import rcl_interfaces as rcl
from roverlink.runtime.middleware import Endpoint, Middleware, NodeIdentity, examine_zenoh, open_middleware
from roverlink.runtime.ros_arguments import parameters
from roverlink.runtime.ros_arguments.live_parameters import LiveParameters

pytest.importorskip("zenoh", reason=NO_ZENOH)

import zenoh

from roverlink.runtime.middleware.zenoh_keys import NODE, PUBLISHER, SUBSCRIPTION, Entity, entity_of

_IMU = f"comms::msg::dds_::ImuSensorInformation_/{ImuSensorInformation.__typehash__}"
_STRING = "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"
Open = Callable[..., Middleware]


@pytest.fixture
def router(zenoh_router: str, monkeypatch: pytest.MonkeyPatch) -> str:
    """The endpoint of a router for the nodes of a domain and a distribution."""
    monkeypatch.setenv("ROS_DOMAIN_ID", "7")
    monkeypatch.setenv("ROS_DISTRO", "jazzy")
    return zenoh_router


@pytest.fixture
def join(router: str) -> Iterator[Open]:
    """Joins as a node; leaves at the end."""
    with ExitStack() as joined:

        def open_one(name: str = "udp_forwarder", namespace: str = "/", **given: Any) -> Middleware:
            return joined.enter_context(open_middleware("zenoh", NodeIdentity(name, namespace), **given))

        yield open_one


@pytest.fixture
def raw(router: str) -> Iterator[Any]:
    """A session of zenoh's own API: a client of the router."""
    config = zenoh.Config()
    config.insert_json5("mode", '"client"')
    config.insert_json5("connect/endpoints", json.dumps([router]))
    config.insert_json5("scouting/multicast/enabled", "false")
    with zenoh.open(config) as session:
        yield session


def _gathered(middleware: Middleware, topic: str, message_type: Any = ImuSensorInformation, **qos: Any) -> list[bytes]:
    seen: list[bytes] = []
    middleware.subscribe(topic, message_type, Qos(**qos), seen.extend)
    return seen


def _numbered(*numbers: int) -> list[bytes]:
    return [cdr.encode(ImuSensorInformation(accel_x=float(number))) for number in numbers]


# --- the conventions ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("entity", "number", "token"),
    [
        # rmw_zenoh's docs/design.md has these tokens
        (
            Entity(NODE, "aac3178e146ba6f1fc6e6a4085e77f21", NodeIdentity("listener")),
            0,
            "@ros2_lv/2/aac3178e146ba6f1fc6e6a4085e77f21/0/0/NN/%/%/listener",
        ),
        (
            Entity(
                PUBLISHER,
                "8b20917502ee955ac4476e0266340d5c",
                NodeIdentity("talker"),
                "/chatter",
                "std_msgs::msg::dds_::String_",
                _STRING,
                Qos(depth=7),
            ),
            10,
            "@ros2_lv/2/8b20917502ee955ac4476e0266340d5c/0/10/MP/%/%/talker/%chatter/std_msgs::msg::dds_::String_/"
            f"{_STRING}/::,7:,:,:,,",
        ),
        (
            Entity(
                SUBSCRIPTION, "a", NodeIdentity("n", "/rover/arm"), "/rover/x", "T", "H",
                Qos("best_effort", "transient_local", "keep_all", 42),
            ),
            3,
            "@ros2_lv/2/a/0/3/MS/%/%rover%arm/n/%rover%x/T/H/2:1:2,:,:,:,,",
        ),
    ],
)  # fmt: skip
def test_tokens_are_those_of_rmw_zenoh(entity: Entity, number: int, token: str) -> None:
    """A token is written and read, also with the parts that newer releases append."""
    assert entity.token(2, number) == token
    assert entity_of(token) == entity
    if entity.kind != NODE:
        assert entity_of(f"{token}/backends:cuda") == entity
    assert entity_of(token.rpartition("/")[0]) is None or entity.kind == NODE


def test_zenohs_own_api_sees_a_ros_node(join: Open, raw: Any) -> None:
    """Key, token, attachment and payload are what rmw_zenoh writes; the payload is plain CDR."""
    samples: list[Any] = []
    raw.declare_subscriber("7/imu_data/**", samples.append)
    publisher = join(namespace="/rover").publisher("/imu_data", ImuSensorInformation, Qos())
    messages = _numbered(1, 2)

    def both() -> bool:
        publisher.publish(messages)
        return len(samples) > 1

    wait_until(both, "the messages")
    assert str(samples[0].key_expr) == f"7/imu_data/{_IMU}"
    assert [sample.payload.to_bytes() for sample in samples[:2]] == messages
    first, second = (struct.unpack("<qqB16s", sample.attachment.to_bytes()) for sample in samples[:2])
    assert (second[0] - first[0], first[2], first[3]) == (1, 16, second[3])
    assert abs(first[1] - time.time_ns()) < 600e9
    tokens = {str(reply.ok.key_expr) for reply in raw.liveliness().get("@ros2_lv/7/**")}
    described = {token.split("/", 5)[5] for token in tokens}
    assert described >= {"NN/%/%rover/udp_forwarder", f"MP/%/%rover/udp_forwarder/%imu_data/{_IMU}/::,10:,:,:,,"}


def test_the_graph_has_types_qos_and_nodes_until_they_leave(join: Open) -> None:
    """An endpoint with its node and QoS; a topic with its type while it has a publisher."""
    ours, other = join(), join("joystick", "/base")
    qos = Qos(reliability="best_effort", durability="transient_local")
    other.publisher("/drive", DrivingBoardMotorMessage, qos)
    _gathered(other, "/back")
    wait_until(lambda: ours.endpoints("/drive", True) == [Endpoint("/base/joystick", qos)], "the publisher")
    wait_until(lambda: ours.endpoints("/back", False) == [Endpoint("/base/joystick", Qos())], "the subscription")
    assert (ours.endpoints("/drive", False), ours.endpoints("/back", True)) == ([], [])
    assert ours.topics() == {"/drive": "comms/msg/DrivingBoardMotorMessage"}
    assert not ours.publisher("/drive", DrivingBoardMotorMessage, Qos()).has_subscribers()
    assert ours.publisher("/back", ImuSensorInformation, Qos()).has_subscribers()
    other.close()
    wait_until(lambda: not ours.endpoints("/back", False), "the node to leave")


@pytest.mark.parametrize("reliability", ["reliable", "best_effort"])
def test_latched_messages_reach_late_subscriptions(join: Open, reliability: str) -> None:
    """A late subscription gets the last messages, as many as the depth says; a volatile one gets none of them."""
    publisher = join("map").publisher("/map", ImuSensorInformation, Qos(reliability, "transient_local", depth=2))
    publisher.publish(_numbered(1, 2, 3))
    late = join("late")
    live = _gathered(late, "/map", reliability=reliability)
    kept = _gathered(late, "/map", reliability=reliability, durability="transient_local", depth=2)
    wait_until(lambda: len(kept) == 2, "the latched messages")
    publisher.publish(_numbered(4))
    wait_until(lambda: live and len(kept) == 3, "the new message")
    assert (kept, live) == (_numbered(2, 3, 4), _numbered(4))


def test_another_definition_of_a_type_is_told(
    join: Open, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """Humble has no type hashes in its keys: nothing passes, and a warning names node, types and the cure."""
    ours = join()
    publisher = ours.publisher("/imu_data", ImuSensorInformation, Qos())
    monkeypatch.setenv("ROS_DISTRO", "humble")
    humble = join("humble")
    seen = _gathered(humble, "/imu_data")
    wait_until(lambda: "nothing passes between this node and /humble" in caplog.text, "the warning")
    assert "TypeHashNotSupported" in caplog.text
    assert "set ROS_DISTRO" in caplog.text
    assert not publisher.has_subscribers()
    publisher.publish(_numbered(1))
    same = humble.publisher("/imu_data", ImuSensorInformation, Qos())
    same.publish(_numbered(2))
    wait_until(lambda: seen, "the message of the same distribution")
    assert seen == _numbered(2)


# --- delivery -------------------------------------------------------------------------------------------------------


def test_what_a_link_held_back_is_no_command(
    join: Open, raw: Any, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """A message that comes more than a second later than others of its sender is counted instead of sent to a peer.

    Others get it late, and say so. It makes no difference what the clocks say.
    """
    drive = REGISTRY.by_name["drive_motor"]
    key = f"7/drive_motor/comms::msg::dds_::DrivingBoardMotorMessage_/{DrivingBoardMotorMessage.__typehash__}"
    messages = [drive.to_cdr(drive.payload_type(distance_to_go=number)) for number in range(8)]
    seen = _gathered(join("basestation"), "/drive_motor", DrivingBoardMotorMessage)
    publisher = raw.declare_publisher(key)
    now, clocks, arrived = time.time_ns(), count(-7_200, 10), list[bytes]()
    with Rig(middleware=lambda _: join()) as rig:

        def send(number: int, clock_s: float) -> None:
            attachment = struct.pack("<qqB16s", number, now + int(clock_s * 1e9), 16, b"g" * 16)
            publisher.put(messages[number], attachment=attachment)

        def first() -> bool:
            send(0, next(clocks))
            return bool(seen and rig.account.sent["drive_motor"])

        def has_come(number: int) -> bool:
            arrived.extend(rig.arrived("hardware"))
            return seen[-1:] == [messages[number]] and envelope(drive_motor={"distance_to_go": number}) in arrived

        wait_until(first, "the first message")
        send(1, -3_600)
        for number in range(2, 6):  # set back: the first one says so, and the others are measured by it
            send(number, -9_000 + 60 * number)
        wait_until(lambda: has_come(5), "the messages")
        send(6, 0)
        wait_until(lambda: has_come(6), "the clock that was set right")
        assert not rig.account.late
        monotonic = time.monotonic_ns
        monkeypatch.setattr(time, "monotonic_ns", lambda: monotonic() + int(1.5e9))
        send(7, 0.1)  # 0.1 s after the last one, and comes 1.5 s after it
        wait_until(lambda: seen[-1] == messages[7] and rig.account.late, "the late message")
        wait_until(lambda: "messages come more than a second late, on /drive_motor" in caplog.text, "the warning")
        assert rig.account.late == {"drive_motor": 1}
        assert "not sent: drive_motor: the message came more than a second late" in caplog.text
        assert rig.account.sent["drive_motor"] == rig.account.taken["drive_motor"] - 1
        assert not has_come(7)


@pytest.mark.parametrize("exact_depth", [True, False])
def test_a_slow_callback_holds_up_no_urgent_topic(
    join: Open, caplog: pytest.LogCaptureFixture, exact_depth: bool
) -> None:
    """While a callback works, newer messages replace the oldest ones of its topic, and an urgent topic comes next.

    Messages that are replaced are told, unless the depth was to be exact.
    """
    ours, other = join(), join("other")
    images = other.publisher("/image", ImuSensorInformation, Qos())
    stops = other.publisher("/stop", ImuSensorInformation, Qos())
    order: list[tuple[str, float]] = []

    def note(topic: str) -> Callable[[Sequence[bytes]], None]:
        def take(messages: Sequence[bytes]) -> None:
            if not order:
                order.append(("busy", 0))
                images.publish(_numbered(*range(400)))
                # When the second one waits, the thread has been told of the first one.
                wait_until(lambda: stops.publish(_numbered(9)) and len(urgent.waiting) > 1, "stops, and all before")
            order.extend((topic, cdr.decode(ImuSensorInformation, one).accel_x) for one in messages)

        return take

    ours.subscribe("/image", ImuSensorInformation, Qos(depth=3), note("image"), exact_depth=exact_depth)
    urgent: Any = ours.subscribe("/stop", ImuSensorInformation, Qos(), note("stop"), priority=1)
    wait_until(images.has_subscribers, "the subscription")
    images.publish(_numbered(-1))
    wait_until(lambda: ("image", 399) in order, "the newest message")
    assert [one for one in order if one[0] == "image"][-3:] == [("image", 397), ("image", 398), ("image", 399)]
    assert order.index(("stop", 9)) < order.index(("image", 397))
    wait_until(lambda: exact_depth or "gave way to newer ones, on /image" in caplog.text, "the warning")
    assert exact_depth is not ("gave way" in caplog.text)


def test_a_closed_subscription_leaves_the_thread_at_rest(join: Open) -> None:
    """What still waits for it is dropped, and costs nothing from then on."""
    begun, over = threading.Event(), threading.Event()
    subscription: Any = join().subscribe("/imu_data", ImuSensorInformation, Qos(), lambda _: (begun.set(), over.wait()))
    publisher = join("talker").publisher("/imu_data", ImuSensorInformation, Qos())
    wait_until(publisher.has_subscribers, "the subscription")
    publisher.publish(_numbered(1))
    assert begun.wait(PATIENCE_S)
    publisher.publish(_numbered(2))
    wait_until(lambda: subscription.waiting, "a message that waits")
    subscription.close()
    over.set()
    used = time.process_time()
    time.sleep(0.3)  # the CPU time of a while is what is judged
    assert time.process_time() - used < 0.2


def test_a_node_that_has_left_accepts_nothing(join: Open) -> None:
    """What is published after the node has gone is not taken for published, and is no error."""
    node = join()
    publisher = node.publisher("/imu_data", ImuSensorInformation, Qos())
    assert publisher.publish(_numbered(1, 2)) == 2
    node.close()
    node.close()
    assert publisher.publish(_numbered(3)) == 0


# --- services -------------------------------------------------------------------------------------------------------


def test_parameter_services_answer(join: Open) -> None:
    """A client reads and sets parameters, gets the reason of a refusal, and hears of the change."""
    live = LiveParameters(REGISTRY, parameters.read(REGISTRY, {}), logging.getLogger("test_zenoh"))
    live.on_change(lambda _: None)
    join("udp_forwarder", "/rover", parameters=live)
    other = join("ros2cli")
    events = _gathered(other, "/parameter_events", rcl.ParameterEvent)

    def ask(name: str, request: Any, response: Any) -> Any:
        client = other.client(f"/rover/udp_forwarder/{name}", RowService(name, type(request), response))
        answers: list[bytes] = []
        wait_until(lambda: client.call(cdr.encode(request), answers.append), name)
        return cdr.decode(response, wait_until(lambda: answers, f"the response of {name}")[0])

    got = ask("get_parameters", rcl.GetParametersRequest(["dst_ip", "listen_port"]), rcl.GetParametersResponse)
    assert [(value.string_value, value.integer_value) for value in got.values] == [("127.0.0.1", 0), ("", 5000)]
    value = rcl.ParameterValue(rcl.ParameterValue.STRING, string_value="10.0.0.7")
    for name, said in (("dst_ip", ""), ("listen_port", "read-only")):
        changed = ask(
            "set_parameters", rcl.SetParametersRequest([rcl.Parameter(name, value)]), rcl.SetParametersResponse
        )
        assert changed.results[0].successful is (not said)
        assert said in changed.results[0].reason
    assert live.values["dst_ip"] == "10.0.0.7"
    event = cdr.decode(rcl.ParameterEvent, wait_until(lambda: events, "the event")[0])
    assert (event.node, event.changed_parameters[0].name) == ("/rover/udp_forwarder", "dst_ip")


def test_a_service_that_nobody_offers_is_told(join: Open) -> None:
    """A call returns at once, without a response."""
    service = RowService("x", rcl.GetParametersRequest, rcl.GetParametersResponse)
    assert not join().client("/x", service).call(cdr.encode(rcl.GetParametersRequest()), pytest.fail)


# --- the configuration ----------------------------------------------------------------------------------------------


def test_the_configuration_is_zenohs_own(
    router: str, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture, tmp_path: Any
) -> None:
    """A file and single values; a mistake, a router that is not there, and a refusal are one line, as for doctor."""
    file = tmp_path / "session.json5"
    file.write_text(
        f'{{mode: "client", connect: {{endpoints: ["{router}"]}}, scouting: {{multicast: {{enabled: false}}}}}}'
    )
    monkeypatch.setenv("ZENOH_SESSION_CONFIG_URI", str(file))
    monkeypatch.setenv("ZENOH_CONFIG_OVERRIDE", "timestamping/enabled=true;")
    open_middleware("zenoh", NodeIdentity("client")).close()
    assert not caplog.records
    for override, said in (
        ("mode", "'mode' is not KEY=VALUE"),
        ('mode="rover"', "zenoh refuses ZENOH_CONFIG_OVERRIDE"),
        (
            'connect/timeout_ms=0;connect/endpoints=["tcp/127.0.0.1:1"]',
            "zenoh cannot open a session: Unable to connect to any of [Single(tcp/127.0.0.1:1)]",
        ),
    ):
        monkeypatch.setenv("ZENOH_CONFIG_OVERRIDE", override)
        with pytest.raises(MiddlewareError) as refused:
            open_middleware("zenoh", NodeIdentity("client"))
        assert said in str(refused.value)
        assert ".rs" not in str(refused.value)
    monkeypatch.setenv("ZENOH_CONFIG_OVERRIDE", "")
    assert examine_zenoh() == (f"a router answers at {router}", [ANY])
    with open_middleware("zenoh", NodeIdentity("client")) as node, pytest.raises(MiddlewareError, match="timestamp"):
        node.publisher("/map", ImuSensorInformation, Qos("best_effort", "transient_local"))
    assert "timestamping/enabled=true" in caplog.text
    file.write_text("{mode: ")
    with pytest.raises(
        MiddlewareError, match=r"zenoh refuses ZENOH_SESSION_CONFIG_URI='.*': --> 1:8 .*expected"
    ) as bad:
        examine_zenoh()
    assert "\n" not in str(bad.value)


@pytest.mark.slow
def test_a_node_without_a_router_says_so(monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture) -> None:
    """A peer starts, because the router may come later, and names the command that starts one."""
    monkeypatch.setenv("ZENOH_CONFIG_OVERRIDE", 'connect/endpoints=["tcp/127.0.0.1:1"]')
    monkeypatch.delenv("ZENOH_SESSION_CONFIG_URI", raising=False)
    with open_middleware("zenoh", NodeIdentity("alone")):
        assert "no zenoh router answers at tcp/127.0.0.1:1" in caplog.text
        assert "zenoh-router" in caplog.text
    with pytest.raises(MiddlewareError, match="no zenoh router answers at tcp/127"):
        examine_zenoh()


# --- strangers ------------------------------------------------------------------------------------------------------


@pytest.fixture
def sdk(router: str) -> Iterator[Any]:
    """The package zenoh-ros2-sdk, whose nodes share one session; it computes type hashes of its own."""
    sdk = pytest.importorskip("zenoh_ros2_sdk", reason=NO_ZENOH_JUDGES)
    with ExitStack() as held:
        session = sdk.session.ZenohSession.get_instance("127.0.0.1", int(router.rpartition(":")[2]))
        held.callback(session.close)
        yield sdk


def test_keys_are_those_of_a_stranger() -> None:
    """The package pamoja-ros2 makes the same data keys of topics and services."""
    ros2 = pytest.importorskip("pamoja.ros2", reason=NO_ZENOH_JUDGES)
    for name, type_name in (("/chatter", "std_msgs/msg/String"), ("/rover/node/get", "a_b/srv/Get")):
        ours = Entity(PUBLISHER, "a", NodeIdentity("n"), name, ros2.dds_type_name(type_name), _STRING)
        assert ours.key(42) == ros2.entity_key(42, name, type_name, _STRING)


@pytest.mark.slow
def test_topics_are_exchanged_with_a_stranger(join: Open, sdk: Any) -> None:
    """Its subscription gets our messages, and ours gets those of its publisher, with the hashes that it computes."""
    string = standard_types.message_type("std_msgs/msg/String")
    ours, heard = join(), list[str]()
    seen = _gathered(ours, "/back", string)
    publisher = ours.publisher("/chatter", string, Qos())
    given = {"msg_type": "std_msgs/msg/String", "msg_definition": "string data\n", "domain_id": 7}
    listener = sdk.ROS2Subscriber("/chatter", callback=lambda message: heard.append(message.data), **given)
    wait_until(lambda: publisher.publish([cdr.encode(string("to the stranger"))]) and heard, "our message")
    talker = sdk.ROS2Publisher("/back", node_name="stranger", namespace="/far", **given)
    wait_until(lambda: ours.endpoints("/back", True), "the stranger's publisher")
    assert ours.endpoints("/back", True)[0].node == "/far/stranger"
    assert ours.topics()["/back"] == "std_msgs/msg/String"
    wait_until(lambda: talker.publish(data="to us") or seen, "its message")
    assert (heard[0], cdr.decode(string, seen[0])) == ("to the stranger", string("to us"))
    listener.close()
    talker.close()


def test_services_are_exchanged_with_a_stranger(join: Open, sdk: Any) -> None:
    """Its client asks our node for the types of parameters, and our client asks its server."""
    live = LiveParameters(REGISTRY, parameters.read(REGISTRY, {}), logging.getLogger("test_zenoh"))
    ours = join(parameters=live)
    given = {
        "srv_type": "rcl_interfaces/srv/GetParameterTypes",
        "request_definition": "string[] names\n",
        "response_definition": "uint8[] types\n",
        "domain_id": 7,
    }
    client = sdk.ROS2ServiceClient("/udp_forwarder/get_parameter_types", **given)
    response = wait_until(lambda: client.call(names=["dst_ip", "listen_port"]), "the response")
    assert list(response.types) == [4, 2]

    def answer(request: Any) -> Any:
        return server.response_msg_class(types=numpy.array([len(request.names)], numpy.uint8))

    server = sdk.ROS2ServiceServer("/far/types", callback=answer, **given)
    service = RowService("types", rcl.GetParameterTypesRequest, rcl.GetParameterTypesResponse)
    asked, answers = ours.client("/far/types", service), list[bytes]()
    wait_until(lambda: asked.call(cdr.encode(rcl.GetParameterTypesRequest(["a", "b"])), answers.append), "the server")
    wait_until(lambda: answers, "the response")
    assert cdr.decode(rcl.GetParameterTypesResponse, answers[0]).types == b"\2"
    client.close()
    server.close()


@pytest.mark.slow
def test_one_basestation_sees_a_fleet(start: Start, done: Start, environment: dict[str, str], free_port: int) -> None:
    """Two rovers in their namespaces, and a program that shows both, find each other through the command's router."""
    endpoint = f"tcp/127.0.0.1:{free_port}"
    environment["ROS_DISTRO"] = "jazzy"
    environment["ZENOH_CONFIG_OVERRIDE"] = f'connect/endpoints=["{endpoint}"]'
    router = start("zenoh-router", "--listen", endpoint)
    router.wait_for("runs")
    for rover in ("rover1", "rover2"):
        ports = ("-p", "listen_port:=0", "-p", "listen_address:='127.0.0.1'")
        start("run", "--middleware", "zenoh", "--ros-args", "-r", f"__ns:=/{rover}", *ports).wait_for("on UDP port ")
    _, output, errors = done("top", "--once", "--json", "--middleware", "zenoh")  # type: ignore[misc]
    assert all(f"/{rover}/udp_forwarder" in output for rover in ("rover1", "rover2")), errors
    router.send_signal(signal.SIGINT)
    assert router.end() == 0
