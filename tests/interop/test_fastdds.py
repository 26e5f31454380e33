"""The bridge and the commands against Fast DDS, ROS 2's default middleware, of which we share no line."""

from __future__ import annotations

import contextlib
import fcntl
import hashlib
import json
import os
import queue
import re
import shutil
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any, cast

import pytest
from needs import NO_DDS
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from generated.registry import REGISTRY
from roverlink.runtime.core.registry import AnyHandler

pytest.importorskip("cyclonedds", reason=NO_DDS)

ROOT = Path(__file__).parents[2]
SOURCE = Path(__file__).with_name("fastdds_peer.cpp")
COMPILE = ("g++", "-std=c++17", "-Wall", "-Wextra", "-pthread")
LIBRARIES = ("-lfastrtps", "-lfastcdr")
VERSIONS = """
#include <fastrtps/config.h>
#include <fastcdr/config.h>
#if FASTRTPS_VERSION_MAJOR != 2 || FASTCDR_VERSION_MAJOR != 1
#error
#endif
FASTRTPS_VERSION_STR FASTCDR_VERSION_STR
"""
PATIENCE_S = 20.0
IMU = "comms/msg/ImuSensorInformation"
MOTOR = "comms/msg/DrivingBoardMotorMessage"
STRING = "std_msgs/msg/String"


# --- Fast DDS -----------------------------------------------------------------------------------------------------


@pytest.fixture(scope="session")
def program() -> Path:
    """The Fast DDS peer, compiled where that was not done before."""
    if shutil.which("g++") is None:
        pytest.skip("need g++ (apt-get install g++)")
    environment = {**os.environ, "LC_ALL": "C"}
    versions = subprocess.run(
        ("g++", "-E", "-P", "-x", "c++", "-"),
        input=VERSIONS.encode(),
        capture_output=True,
        env=environment,
        check=False,
    )
    if versions.returncode != 0:
        pytest.skip("need Fast DDS 2 with Fast CDR 1 (apt-get install libfastrtps-dev libfastcdr-dev)")
    fingerprint = hashlib.sha256(versions.stdout + SOURCE.read_bytes() + repr(COMPILE).encode()).hexdigest()[:16]
    folder = ROOT / "build" / "interop"
    folder.mkdir(parents=True, exist_ok=True)
    built = folder / f"fastdds_peer-{fingerprint}"
    with (folder / "lock").open("w") as lock:  # other workers of this test run want it too
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not built.exists():
            unfinished = built.with_suffix(".unfinished")
            subprocess.run((*COMPILE, str(SOURCE), "-o", str(unfinished), *LIBRARIES), env=environment, check=True)
            unfinished.replace(built)
    return built


@dataclass(frozen=True)
class FastDds:
    """Another node on the graph, which is made of Fast DDS."""

    program: Path
    domain: int

    def subscribe(self, topic: str, message_type: str, count: int) -> Child:
        """Prints serialized messages in hexadecimal."""
        return self._child("subscribe", topic, message_type, str(count))

    def publish(self, topic: str, message_type: str, message: bytes, count: int) -> Child:
        """Publishes a serialized message once there is a subscriber; one that takes `count` of 2 or more gets it."""
        return self._child("publish", topic, message_type, message.hex(), str(count))

    def graph(self, gid_size: int) -> Child:
        """Prints endpoints and nodes."""
        return self._child("graph", str(gid_size))

    def _child(self, *arguments: str) -> Child:
        return Child(str(self.program), str(self.domain), *arguments)


@pytest.fixture
def fast_dds(program: Path, domain: int) -> FastDds:
    """Fast DDS in a domain of the test's own."""
    return FastDds(program, domain)


# --- the other processes ------------------------------------------------------------------------------------------


class Child:
    """A program that runs while in the context, and whose lines are waited for."""

    def __init__(self, *command: str, environment: Mapping[str, str] | None = None, with_log: bool = False) -> None:
        """``with_log``: its standard error counts as well; else that is shown where a test fails."""
        self._name = " ".join(command)
        self._process = subprocess.Popen(
            command,
            cwd=ROOT,
            env=environment,
            text=True,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT if with_log else None,
        )
        self._lines: queue.Queue[str] = queue.Queue()
        self._reader = threading.Thread(target=self._read, daemon=True)

    def __enter__(self) -> Child:
        self._reader.start()
        return self

    def __exit__(self, *_: object) -> None:
        with self._process:
            self._process.terminate()
            try:
                self._process.wait(PATIENCE_S)
            except subprocess.TimeoutExpired:
                self._process.kill()
            self._reader.join()

    def poll(self, seconds: float) -> str | None:
        """The next line, or None where none comes within that time."""
        with contextlib.suppress(queue.Empty):
            return self._lines.get(timeout=seconds)
        return None

    def line(self) -> str:
        """The next line; fails where none comes."""
        line = self.poll(PATIENCE_S)
        assert line is not None, f"nothing more from {self._name} (its exit status: {self._process.poll()})"
        return line

    def succeeds(self) -> bool:
        """Whether it ends by itself, with status 0."""
        return self._process.wait(PATIENCE_S) == 0

    def _read(self) -> None:
        for line in cast(IO[str], self._process.stdout):
            self._lines.put(line.rstrip("\n"))


def roverlink(domain: int, *arguments: str, distribution: str = "humble", with_log: bool = False) -> Child:
    """A roverlink command on loopback, in a domain."""
    own = {"ROS_DOMAIN_ID": str(domain), "ROS_LOCALHOST_ONLY": "1", "ROS_DISTRO": distribution}
    environment = {name: value for name, value in os.environ.items() if name != "CYCLONEDDS_URI"} | own
    return Child(sys.executable, "-m", "roverlink", *arguments, environment=environment, with_log=with_log)


@dataclass(frozen=True)
class RunningBridge:
    """A bridge, and what its boards would send and receive with."""

    port: int
    board: socket.socket

    def receive(self, **payload: Any) -> None:
        """Send it an envelope, as a board would."""
        self.board.sendto(REGISTRY.envelope(**payload).SerializeToString(), ("127.0.0.1", self.port))


@contextlib.contextmanager
def bridge(domain: int, distribution: str = "humble") -> Iterator[RunningBridge]:
    """The node udp_forwarder, as it is started on a rover, with ports of its own."""
    with contextlib.ExitStack() as opened:
        board, basestation = (opened.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) for _ in range(2))
        ports = {"listen_port": 0}
        for name, peer in (("dst_b_port", board), ("dst_a_port", basestation)):
            peer.bind(("127.0.0.1", 0))
            peer.settimeout(PATIENCE_S)
            ports[name] = peer.getsockname()[1]
        parameters = [word for name, value in ports.items() for word in ("-p", f"{name}:={value}")]
        command = ("run", "--middleware", "dds", "--ros-args", *parameters)
        child = opened.enter_context(roverlink(domain, *command, distribution=distribution, with_log=True))
        while not (started := re.search(r"bridges \d+ messages on UDP port (\d+)", child.line())):
            pass
        yield RunningBridge(int(started[1]), board)


# --- what the bytes must be ---------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def types() -> Typestore:
    """The rosbags package, another independent implementation, knowing the generated .msg files."""
    store = get_typestore(Stores.ROS2_HUMBLE)
    for path in sorted((ROOT / "generated" / "ros" / "comms" / "msg").glob("*.msg")):
        store.register(get_types_from_msg(path.read_text(encoding="utf-8"), f"comms/msg/{path.stem}"))
    return store


def serialized(types: Typestore, message_type: str, **values: Any) -> bytes:
    """A message as ROS 2 serializes it."""
    return bytes(types.serialize_cdr(types.types[message_type](**values), message_type))


def without_slack(received: str, expected: bytes) -> bytes:
    """What was received in hexadecimal, less the bytes that a middleware may append to fill a word."""
    data = bytes.fromhex(received)
    slack = -len(expected) % 4
    return data[: len(expected)] if len(data) == len(expected) + slack and not any(data[len(expected) :]) else data


def answer(child: Child, ask: Callable[[], None]) -> str:
    """The first line that a child says when it is asked again and again: who asks too early is not heard."""
    deadline = time.monotonic() + PATIENCE_S
    while time.monotonic() < deadline:
        ask()
        if (line := child.poll(0.05)) is not None:
            return line
    return child.line()


IMU_AXES = ("accel_x", "accel_y", "accel_z", "gyro_x", "gyro_y", "gyro_z", "mag_x", "mag_y", "mag_z")


def imu_values(number: int) -> dict[str, Any]:
    """A sample that no other number gives, less its state, which is a message of its own in ROS 2."""
    axes = {axis: number + place / 8 for place, axis in enumerate(IMU_AXES)}
    return {**axes, "is_calibrated": number % 2 == 0, "error_code": number % 9}


def dds_names(handler: AnyHandler) -> tuple[str, str]:
    """The topic and the type of a row, as ROS 2 names them in DDS."""
    package, _, name = handler.message_type.__msgtype__.split("/")
    return f"rt/{handler.route.topic}", f"{package}::msg::dds_::{name}_"


# --- the tests ----------------------------------------------------------------------------------------------------


def test_datagrams_reach_fast_dds_as_ros_serializes_them(fast_dds: FastDds, types: Typestore) -> None:
    """What a board sends by UDP arrives at a Fast DDS reader in order, byte for byte as ROS 2 has it."""
    state = types.types["comms/msg/SensorState"]
    with bridge(fast_dds.domain) as forwarder, fast_dds.subscribe("/imu_data", IMU, 10_000) as reader:
        first = answer(reader, lambda: forwarder.receive(imu_info=imu_values(0)))
        for burst in range(1, 21, 5):  # sent at once, of which the bridge may make one packet
            numbers = range(burst, burst + 5)
            for number in numbers:
                forwarder.receive(imu_info={**imu_values(number), "state": number % 4})
            for number in numbers:
                values = {**imu_values(number), "state": state(state=number % 4)}
                expected = serialized(types, IMU, **values)
                while (received := reader.line()) == first:  # it may have been sent more than once
                    pass
                assert without_slack(received, expected) == expected


def test_what_fast_dds_publishes_is_sent_to_the_board(fast_dds: FastDds, types: Typestore) -> None:
    """A message that Fast DDS publishes is acknowledged, and arrives by UDP in an envelope as payload number 9."""
    values = {"distance_to_go": 1.5, "turning_radius": -2.25}
    message = serialized(types, MOTOR, **values)
    stops = {  # of every command, until its topic speaks
        REGISTRY.envelope(drive_motor={"distance_to_go": 0.0}).SerializeToString(),
        REGISTRY.envelope(arm_ctrl={}).SerializeToString(),
    }
    with bridge(fast_dds.domain) as forwarder, fast_dds.publish("/drive_motor", MOTOR, message, 3) as writer:
        datagram = next(datagram for datagram in iter(lambda: forwarder.board.recv(2048), b"") if datagram not in stops)
        assert writer.succeeds()
    assert datagram[0] == 9 << 3 | 2  # protobuf's tag of field 9, a message
    assert REGISTRY.envelope.FromString(datagram) == REGISTRY.envelope(drive_motor=values)


@pytest.mark.parametrize(
    ("distribution", "gid_size"), [("humble", 24), pytest.param("jazzy", 16, marks=pytest.mark.slow)]
)
def test_the_bridge_is_a_node_with_all_endpoints(fast_dds: FastDds, distribution: str, gid_size: int) -> None:
    """From ros_discovery_info, Fast DDS knows which endpoints are the node's: one a topic, and /diagnostics."""
    endpoints: dict[str, tuple[str, str]] = {}
    node: dict[str, Any] = {}
    with bridge(fast_dds.domain, distribution), fast_dds.graph(gid_size) as graph:
        while not node or not endpoints.keys() >= {*node["readers"], *node["writers"]}:
            found = json.loads(graph.line())
            if found["kind"] == "node":
                node = found
            else:
                endpoints[found["gid"].ljust(2 * gid_size, "0")] = (found["topic"], found["type"])
    assert (node["namespace"], node["name"]) == ("/", "udp_forwarder")
    handlers = [*REGISTRY.handlers, *REGISTRY.extra_topics]
    inbound, outbound = ([h for h in handlers if h.route.inbound == wanted] for wanted in (True, False))
    diagnostics = ("rt/diagnostics", "diagnostic_msgs::msg::dds_::DiagnosticArray_")
    assert sorted(endpoints[gid] for gid in node["writers"]) == sorted([*map(dds_names, inbound), diagnostics])
    assert sorted(endpoints[gid] for gid in node["readers"]) == sorted(map(dds_names, outbound))


@dataclass(frozen=True)
class Topic:
    """A topic, and a message on it."""

    name: str
    message_type: str
    values: dict[str, Any]
    options: tuple[str, ...] = ()


TOPICS = pytest.mark.parametrize(
    "topic",
    [
        Topic("drive_motor", MOTOR, {"distance_to_go": 1.5, "turning_radius": -2.25}),
        pytest.param(
            Topic("chatter", STRING, {"data": "Grüße"}, ("--type", STRING)),
            marks=pytest.mark.slow,
        ),
    ],
    ids=["of a row", "of a standard type"],
)


@TOPICS
def test_echo_prints_what_fast_dds_publishes(fast_dds: FastDds, types: Typestore, topic: Topic) -> None:
    """`roverlink echo` prints a message that Fast DDS publishes, and exits 0."""
    message = serialized(types, topic.message_type, **topic.values)
    command = ("echo", topic.name, *topic.options, "--middleware", "dds", "--json", "--count", "1")
    with (
        roverlink(fast_dds.domain, *command) as echo,
        fast_dds.publish(f"/{topic.name}", topic.message_type, message, 2),
    ):
        assert json.loads(echo.line()) == topic.values
        assert echo.succeeds()


@TOPICS
def test_fast_dds_receives_what_pub_publishes(fast_dds: FastDds, types: Typestore, topic: Topic) -> None:
    """`roverlink pub` publishes once, to a Fast DDS reader, what ROS 2 would, and exits 0."""
    expected = serialized(types, topic.message_type, **topic.values)
    command = ("pub", topic.name, json.dumps(topic.values), *topic.options, "--middleware", "dds", "--once")
    with (
        fast_dds.subscribe(f"/{topic.name}", topic.message_type, 1) as reader,
        roverlink(fast_dds.domain, *command, "--wait", str(PATIENCE_S)) as pub,
    ):
        assert without_slack(reader.line(), expected) == expected
        assert reader.succeeds()
        assert pub.succeeds()
