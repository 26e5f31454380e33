"""Real DDS on loopback, against a program that shares no code with the bridge."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import textwrap
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import pytest
from needs import NO_DDS
from polling import PATIENCE_S, wait_until

from generated.messages import DrivingBoardMotorMessage, ImuSensorInformation, SensorState
from roverlink.runtime import MiddlewareError, Qos
from roverlink.runtime.core import cdr
from roverlink.runtime.core.messages import Message
from roverlink.runtime.interfaces import from_rosbags
from roverlink.runtime.middleware import Endpoint, Middleware, NodeIdentity, open_middleware
from roverlink.runtime.middleware.following import FollowingSubscription
from roverlink.runtime.text.values import message_to_values

pytest.importorskip("cyclonedds", reason=NO_DDS)

_PEER = Path(__file__).with_name("dds_peer.py")
_DOMAIN = str(1 + os.getpid() % 50)  # one of its own for each test worker
_SAMPLE = ImuSensorInformation(
    *[number / 4 for number in range(1, 10)], is_calibrated=True, state=SensorState(3), error_code=8
)

Open = Callable[..., Middleware]


@pytest.fixture(autouse=True)
def _alone_on_loopback(monkeypatch: pytest.MonkeyPatch) -> None:
    """Stay on this host, in a domain of our own."""
    for name in ("CYCLONEDDS_URI", "ROS_AUTOMATIC_DISCOVERY_RANGE", "ROS_DISTRO"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("ROS_LOCALHOST_ONLY", "1")
    monkeypatch.setenv("ROS_DOMAIN_ID", _DOMAIN)


@pytest.fixture
def join() -> Iterator[Open]:
    """Joins the domain as a node; leaves it at the end."""
    joined: list[Middleware] = []

    def open_one(name: str = "udp_forwarder", namespace: str = "/") -> Middleware:
        middleware = open_middleware("dds", NodeIdentity(name, namespace))
        joined.append(middleware.__enter__())
        return middleware

    yield open_one
    for middleware in joined:
        middleware.__exit__(None, None, None)


@pytest.fixture
def topic(request: pytest.FixtureRequest) -> str:
    """A topic that no other test has."""
    name: str = "/" + "".join(c if c.isalnum() else "_" for c in request.node.name)
    return name


class _Peer:
    """The other program, and the lines that it says."""

    def __init__(self, *arguments: object) -> None:
        self._child = subprocess.Popen(
            [sys.executable, str(_PEER), *map(str, arguments)], stdout=subprocess.PIPE, text=True
        )

    def says(self) -> dict[str, Any]:
        """Its next line; fails where it ends without one."""
        assert self._child.stdout is not None
        line = self._child.stdout.readline()
        assert line, "the other program ended without a word"
        said: dict[str, Any] = json.loads(line)
        return said

    def __enter__(self) -> _Peer:
        return self

    def __exit__(self, *_: object) -> None:
        self._child.kill()
        self._child.communicate()


def _gathered(middleware: Middleware, topic: str, message_type: type[Message], qos: Qos | None = None) -> list[bytes]:
    """What comes in on a topic from now on."""
    seen: list[bytes] = []
    middleware.subscribe(topic, message_type, qos or Qos(), seen.extend)
    return seen


# --- the graph --------------------------------------------------------------------------------------------------


def test_endpoints_have_the_names_of_their_nodes_and_their_qos(join: Open, topic: str) -> None:
    """Another node's publisher or subscription is listed until it leaves."""
    ours, other = join(), join("joystick", "/base")
    qos = Qos(reliability="best_effort", durability="transient_local")
    other.publisher(topic, ImuSensorInformation, qos)
    _gathered(other, f"{topic}_back", ImuSensorInformation)
    wait_until(lambda: ours.endpoints(topic, True) == [Endpoint("/base/joystick", qos)], "the publisher")
    wait_until(
        lambda: ours.endpoints(f"{topic}_back", False) == [Endpoint("/base/joystick", Qos())], "the subscription"
    )
    assert (ours.endpoints(topic, False), ours.endpoints(f"{topic}_back", True)) == ([], [])
    other.close()
    wait_until(lambda: not ours.endpoints(topic, True), "the publisher to leave")


def test_a_program_without_a_node_is_listed_without_a_name(join: Open, topic: str) -> None:
    """A plain DDS reader has no node."""
    ours = join()
    with _Peer("read", "--topic", f"rt{topic}", "--count", 1) as peer:
        peer.says()
        wait_until(lambda: ours.endpoints(topic, False) == [Endpoint("", Qos())], "the reader")


def test_topics_with_publishers_are_listed_with_their_types(join: Open, topic: str) -> None:
    """A topic is listed while it has a publisher; one that is only read is not."""
    ours, other = join(), join("joystick")
    other.publisher(topic, ImuSensorInformation, Qos())
    _gathered(other, f"{topic}_back", ImuSensorInformation)
    wait_until(lambda: ours.topics().get(topic) == "comms/msg/ImuSensorInformation", "the topic")
    assert f"{topic}_back" not in ours.topics()
    other.close()
    wait_until(lambda: topic not in ours.topics(), "the topic to leave")


# --- the wire ---------------------------------------------------------------------------------------------------


def test_another_program_reads_what_we_publish(join: Open, topic: str) -> None:
    """A plain DDS reader of the ROS 2 type, on the ROS 2 topic, gets our messages field by field."""
    publisher = join().publisher(topic, ImuSensorInformation, Qos())
    with _Peer("read", "--topic", f"rt{topic}", "--count", 2) as peer:
        assert peer.says() == {"ready": True}
        wait_until(publisher.has_subscribers, "the other program's reader")
        assert publisher.publish([cdr.encode(_SAMPLE), cdr.encode(ImuSensorInformation(accel_z=-9.75))]) == 2
        assert peer.says() == message_to_values(_SAMPLE)
        assert peer.says() == message_to_values(ImuSensorInformation(accel_z=-9.75))


def test_we_read_what_another_program_publishes(join: Open, topic: str) -> None:
    """A plain DDS writer's samples come in as plain CDR of the ROS 2 message, and its end is no message."""
    middleware = join()
    seen = _gathered(middleware, topic, ImuSensorInformation)
    with _Peer("write", "--topic", f"rt{topic}", "--sample", json.dumps(message_to_values(_SAMPLE))) as peer:
        wait_until(lambda: seen, "the sample")
        assert cdr.decode(ImuSensorInformation, seen[0]) == _SAMPLE
        assert seen[0].startswith(cdr.LITTLE_ENDIAN)
        assert peer._child.wait(PATIENCE_S) == 0
    # What the writer said when it went comes before this.
    publisher = middleware.publisher(topic, ImuSensorInformation, Qos())
    wait_until(publisher.has_subscribers, "our own reader")
    publisher.publish([cdr.encode(ImuSensorInformation())])
    wait_until(lambda: len(seen) > 1, "our own message")
    assert [cdr.decode(ImuSensorInformation, data) for data in seen] == [_SAMPLE, ImuSensorInformation()]


@pytest.mark.parametrize(
    ("type_name", "values"),
    [
        ("std_msgs/msg/Empty", {}),
        ("std_msgs/msg/String", {"data": "köln"}),
        ("std_msgs/msg/UInt8MultiArray", {"data": b"abcde"}),
        ("tf2_msgs/msg/TFMessage", {}),
        ("unique_identifier_msgs/msg/UUID", {"uuid": bytes(range(16))}),
    ],
)
def test_messages_of_every_shape_cross(join: Open, topic: str, type_name: str, values: dict[str, Any]) -> None:
    """Empty messages, strings, sequences, arrays and nested messages cross as well, at sizes of no whole words."""
    message_type = from_rosbags.message_type(type_name)
    seen = _gathered(join("listener"), topic, message_type)
    publisher = join("talker").publisher(topic, message_type, Qos())
    wait_until(publisher.has_subscribers, "the reader")
    message = message_type(**values)
    assert publisher.publish([cdr.encode(message)]) == 1
    wait_until(lambda: seen, "the message")
    assert cdr.decode(message_type, seen[0]) == message


def test_a_batch_comes_in_order(join: Open, topic: str) -> None:
    """Messages that are published in one go come in their order, and all of them."""
    seen = _gathered(join("listener"), topic, ImuSensorInformation, Qos(depth=1000))
    publisher = join("talker").publisher(topic, ImuSensorInformation, Qos(depth=1000))
    wait_until(publisher.has_subscribers, "the reader")
    messages = [cdr.encode(ImuSensorInformation(accel_x=float(number))) for number in range(500)]
    assert publisher.publish(messages) == 500
    wait_until(lambda: len(seen) == 500, "all messages")
    assert [data[: len(messages[0])] for data in seen] == messages


def test_what_comes_while_we_are_busy_is_kept(join: Open, topic: str) -> None:
    """A burst longer than a topic is deep waits for the thread that takes it: that thread is seldom at once."""
    at_work, may_go_on = threading.Event(), threading.Event()
    seen: list[bytes] = []

    def work(messages: Sequence[bytes]) -> None:
        at_work.set()
        may_go_on.wait(PATIENCE_S)
        seen.extend(messages)

    join("listener").subscribe(topic, ImuSensorInformation, Qos(), work)
    talker = join("talker")
    publisher = talker.publisher(topic, ImuSensorInformation, Qos(depth=1000))
    wait_until(publisher.has_subscribers, "the reader")
    messages = [cdr.encode(ImuSensorInformation(accel_x=float(number))) for number in range(200)]
    publisher.publish(messages[:1])
    assert at_work.wait(PATIENCE_S)
    publisher.publish(messages[1:])
    writer = talker._publishers[-1]._writer  # type: ignore[attr-defined]  # of this middleware
    assert writer.wait_for_acknowledgement(PATIENCE_S)
    may_go_on.set()
    wait_until(lambda: len(seen) == 200, "all messages")
    assert [cdr.decode(ImuSensorInformation, data).accel_x for data in seen] == list(range(200))


# --- quality of service -----------------------------------------------------------------------------------------

_BEST_EFFORT = Qos(reliability="best_effort", depth=5)
_LATCHED = Qos(durability="transient_local", depth=2)


@pytest.mark.parametrize(
    ("written", "refused", "accepted"),
    [
        (_BEST_EFFORT, Qos(), _BEST_EFFORT),
        (Qos(), _LATCHED, _BEST_EFFORT),
        (Qos(), _LATCHED, Qos(history="keep_all")),
    ],
    ids=["reliable reader, best-effort writer", "latched reader, volatile writer", "any history"],
)
def test_qualities_of_service_match_as_ros_2_has_them(
    join: Open, topic: str, written: Qos, refused: Qos, accepted: Qos
) -> None:
    """A reader that asks for more than the writer offers does not match; one that asks for the same or less does."""
    listener = join("listener")
    refused_seen = _gathered(listener, topic, ImuSensorInformation, refused)
    accepted_seen = _gathered(listener, topic, ImuSensorInformation, accepted)
    publisher = join("talker").publisher(topic, ImuSensorInformation, written)
    wait_until(publisher.has_subscribers, "the reader that matches")  # the other one was announced before it
    publisher.publish([cdr.encode(_SAMPLE)])
    wait_until(lambda: accepted_seen, "the message")
    assert not refused_seen


def test_a_late_subscriber_gets_the_last_messages_of_a_latched_topic(join: Open, topic: str) -> None:
    """A transient-local topic keeps as many messages as it is deep for those who come late; a volatile one none."""
    talker = join("talker")
    for latched, qos in (("_latched", _LATCHED), ("_volatile", Qos())):
        publisher = talker.publisher(topic + latched, ImuSensorInformation, qos)
        publisher.publish([cdr.encode(ImuSensorInformation(accel_x=float(number))) for number in range(5)])
    listener = join("listener")
    volatile = _gathered(listener, f"{topic}_volatile", ImuSensorInformation)
    kept = _gathered(listener, f"{topic}_latched", ImuSensorInformation, _LATCHED)
    wait_until(lambda: len(kept) == 2, "the messages that were kept")
    assert [cdr.decode(ImuSensorInformation, data).accel_x for data in kept] == [3.0, 4.0]
    assert not volatile


# --- being a node -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("distribution", "gid_bytes"), [(None, 24), ("humble", 24), ("jazzy", 16), ("rolling", 16)])
def test_we_are_seen_as_a_node_with_our_endpoints(
    join: Open, topic: str, monkeypatch: pytest.MonkeyPatch, distribution: str | None, gid_bytes: int
) -> None:
    """ros_discovery_info has node, namespace and the GIDs of each reader and writer, as long as ROS 2 has them."""
    if distribution is not None:
        monkeypatch.setenv("ROS_DISTRO", distribution)
    node = join("udp_forwarder", "/rover")
    publishers = [node.publisher(f"{topic}/out{n}", ImuSensorInformation, Qos()) for n in range(2)]
    seen = _gathered(node, f"{topic}/in", ImuSensorInformation)
    with _Peer("graph", "--node", "udp_forwarder", "--count", 3, "--gid-bytes", gid_bytes) as peer:
        said = peer.says()
    assert said["type_names"] == ["comms::msg::dds_::ImuSensorInformation_"]
    assert said["user_data"] == [f"typehash={ImuSensorInformation.__typehash__};"]  # as rmw_dds_common writes it
    padding = "00" * (gid_bytes - 16)
    assert said["namespace"] == "/rover"
    assert said["readers"] == [said["endpoints"][f"rt{topic}/in"] + padding]
    assert said["writers"] == [said["endpoints"][f"rt{topic}/out{n}"] + padding for n in range(2)]
    assert len(publishers) == 2
    assert not seen


_COME_AND_GO = """
import sys
from generated.messages import ImuSensorInformation
from roverlink.runtime import Qos
from roverlink.runtime.middleware import NodeIdentity, open_middleware

class Owner:
    def __init__(self):
        self.middleware = open_middleware("dds", NodeIdentity("guest"))
        self.publisher = self.middleware.publisher(sys.argv[1], ImuSensorInformation, Qos())
        self.middleware.subscribe("/in", ImuSensorInformation, Qos(), lambda data: self)  # as a bridge holds itself

owner = Owner()
with owner.middleware:
    print("here", flush=True)
    sys.stdin.readline()
"""


def test_leaving_takes_the_node_away_at_once(join: Open, topic: str) -> None:
    """A program that has left is not listed for ten more seconds, as one that crashed is."""
    seen = _gathered(join(), topic, ImuSensorInformation)
    watcher = join("watcher").publisher("/in", ImuSensorInformation, Qos())
    with subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(_COME_AND_GO), topic],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        cwd=Path(__file__).parents[2],
    ) as guest:
        wait_until(watcher.has_subscribers, "the guest")
        assert guest.stdin is not None
        guest.stdin.write("\n")
        guest.stdin.flush()
        assert guest.wait(PATIENCE_S) == 0
        start = time.monotonic()
        wait_until(lambda: not watcher.has_subscribers(), "the guest's leave")
        assert time.monotonic() - start < 5.0  # else it is its lease that has run out, after ten
    assert not seen


def test_a_publisher_of_a_node_that_has_left_fails(topic: str) -> None:
    """What is published after the node has gone is not taken for published, nor for a subscriber that is slow."""
    with open_middleware("dds", NodeIdentity("node")) as middleware:
        publisher = middleware.publisher(topic, ImuSensorInformation, Qos())
        assert publisher.publish([cdr.encode(_SAMPLE)]) == 1
    middleware.close()
    with pytest.raises(MiddlewareError, match=f"Cyclone DDS cannot write on rt{topic}"):
        publisher.publish([cdr.encode(_SAMPLE)])


def test_a_subscription_can_end(join: Open, topic: str) -> None:
    """It leaves the graph, its callback is not called any more, and other subscriptions go on, also under load."""
    ours, other = join(), join("other")
    ended, staying = list[bytes](), _gathered(ours, topic, ImuSensorInformation)
    publisher = other.publisher(topic, ImuSensorInformation, Qos())
    sample = cdr.encode(_SAMPLE)
    for _ in range(20):
        subscription = ours.subscribe(topic, ImuSensorInformation, Qos(), ended.extend)

        def both() -> bool:
            publisher.publish([sample])
            return bool(ended)

        wait_until(both, "a message")
        subscription.close()
        wait_until(lambda: len(other.endpoints(topic, False)) == 1, "the end of the subscription")
        ended.clear()
        staying.clear()
        publisher.publish([sample])
        wait_until(lambda: staying, "a message of the other subscription")
        assert not ended


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
    marks = _gathered(join("third"), topic, ImuSensorInformation, Qos("best_effort"))

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
            return bool(seen)

        wait_until(heard, "a message")
        assert seen[0] is message_type
        wait_until(lambda: [one.qos for one in node.endpoints(topic, False)] == [qos], "the QoS")  # noqa: B023
        node.close()
        wait_until(lambda: topic not in ours.topics(), "the publisher to leave")
        seen.clear()


def test_a_late_subscriber_gets_the_next_message(join: Open, topic: str) -> None:
    """Messages to nobody count as published, and a subscriber gets those that follow after it was found."""
    publisher, listener = join().publisher(topic, ImuSensorInformation, Qos()), join()
    assert publisher.publish([cdr.encode(ImuSensorInformation())] * 3) == 3
    seen = _gathered(listener, topic, ImuSensorInformation)
    wait_until(publisher.has_subscribers, "the late subscriber")
    assert publisher.publish([cdr.encode(_SAMPLE)]) == 1
    wait_until(lambda: seen, "the next message")
    assert [cdr.decode(ImuSensorInformation, data) for data in seen] == [_SAMPLE]


# --- the environment --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("domain", ["rover", "233", "-1", "1.5", "0x1"])
def test_a_domain_id_that_cannot_be_is_told(monkeypatch: pytest.MonkeyPatch, domain: str) -> None:
    """A wrong ROS_DOMAIN_ID is quoted, with what it may be."""
    monkeypatch.setenv("ROS_DOMAIN_ID", domain)
    with pytest.raises(MiddlewareError, match=f"ROS_DOMAIN_ID is '{domain}'; set it to a number from 0 to 232"):
        open_middleware("dds", NodeIdentity("node"))


_ALONE = """
import os, sys, time
os.environ.update({environment!r})
from generated.messages import ImuSensorInformation
from roverlink.runtime import MiddlewareError, Qos
from roverlink.runtime.middleware import NodeIdentity, open_middleware

try:
    with open_middleware("dds", NodeIdentity("alone")) as middleware:
        publisher = middleware.publisher(sys.argv[1], ImuSensorInformation, Qos())
        deadline = time.monotonic() + 30
        while not publisher.has_subscribers() and time.monotonic() < deadline:
            time.sleep(0.01)
        print("matched" if publisher.has_subscribers() else "nobody")
except MiddlewareError as error:
    print("refused:", error)
"""


def _alone(topic: str, **environment: str) -> str:
    done = subprocess.run(
        [sys.executable, "-c", _ALONE.format(environment=environment), topic],
        capture_output=True,
        text=True,
        cwd=Path(__file__).parents[2],
        timeout=3 * PATIENCE_S,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


_OWN_CONFIGURATION = (
    '<CycloneDDS><Domain><General><Interfaces><NetworkInterface address="127.0.0.1"/></Interfaces></General>'
    '<Discovery><ParticipantIndex>auto</ParticipantIndex><Peers><Peer address="localhost"/></Peers></Discovery>'
    "</Domain></CycloneDDS>"
)


@pytest.mark.parametrize(
    "environment",
    [
        {"ROS_LOCALHOST_ONLY": "1"},
        {"ROS_LOCALHOST_ONLY": "0", "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"},
        {"ROS_LOCALHOST_ONLY": "0", "CYCLONEDDS_URI": _OWN_CONFIGURATION},
        {"ROS_LOCALHOST_ONLY": "1", "CYCLONEDDS_URI": _OWN_CONFIGURATION},
    ],
    ids=["localhost only", "discovery range", "own configuration", "own configuration and localhost only"],
)
def test_each_way_to_stay_on_this_host_finds_the_others(join: Open, topic: str, environment: dict[str, str]) -> None:
    """ROS 2's variables, old and new, and a Cyclone DDS configuration of the user's own lead to the same place."""
    seen = _gathered(join(), topic, ImuSensorInformation)
    assert _alone(topic, **environment) == "matched"
    assert not seen


def test_a_configuration_that_cyclone_does_not_take_is_told(topic: str) -> None:
    """A broken CYCLONEDDS_URI is an error with the domain's number, not a traceback."""
    said = _alone(topic, CYCLONEDDS_URI="<CycloneDDS><Nonsense/></CycloneDDS>")
    assert said.startswith(f"refused: Cyclone DDS cannot join domain {_DOMAIN}: ")


def test_a_program_that_is_in_the_domain_already_can_join_as_a_node(topic: str) -> None:
    """A program with DDS entities of its own may run a bridge as well: the domain stays as it configured it."""
    from cyclonedds.domain import Domain, DomainParticipant

    other_domain = int(_DOMAIN) + 50
    domain = Domain(other_domain, _OWN_CONFIGURATION)
    participant = DomainParticipant(other_domain)
    with pytest.MonkeyPatch.context() as monkeypatch:
        monkeypatch.setenv("ROS_DOMAIN_ID", str(other_domain))
        with open_middleware("dds", NodeIdentity("node")) as middleware:
            assert middleware.publisher(topic, ImuSensorInformation, Qos()).publish([cdr.encode(_SAMPLE)]) == 1
    del participant, domain
