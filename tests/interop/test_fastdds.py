"""The bridge and the commands against Fast DDS, ROS 2's default middleware, of which we share no line."""

from __future__ import annotations

import contextlib
import fcntl
import hashlib
import json
import os
import queue
import shutil
import socket
import subprocess
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any, cast

import pytest
from needs import NO_DDS
from polling import PATIENCE_S
from programs import Program, Start
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


class Peer:
    """Fast DDS in a process of its own, whose lines are waited for."""

    def __init__(self, *command: str) -> None:
        self._command = command
        self._process = subprocess.Popen(command, text=True, stdout=subprocess.PIPE)
        self._lines: queue.Queue[str] = queue.Queue()
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def poll(self, seconds: float) -> str | None:
        """The next line, or None where none comes within that time."""
        with contextlib.suppress(queue.Empty):
            return self._lines.get(timeout=seconds)
        return None

    def line(self) -> str:
        """The next line; fails where none comes."""
        line = self.poll(PATIENCE_S)
        assert line is not None, f"nothing more from {self._command} (its exit status: {self._process.poll()})"
        return line

    def succeeds(self) -> bool:
        """Whether it ends by itself, with status 0."""
        return self._process.wait(PATIENCE_S) == 0

    def close(self) -> None:
        """End it."""
        with self._process:
            self._process.kill()
            self._reader.join()

    def _read(self) -> None:
        for line in cast(IO[str], self._process.stdout):
            self._lines.put(line.rstrip("\n"))


@pytest.fixture
def fast_dds(program: Path, domain: int) -> Iterator[Callable[..., Peer]]:
    """Starts nodes that are made of Fast DDS, with the arguments of `fastdds_peer.cpp` behind the domain."""
    with contextlib.ExitStack() as held:

        def begin(*arguments: object) -> Peer:
            peer = Peer(str(program), str(domain), *map(str, arguments))
            held.callback(peer.close)
            return peer

        yield begin


@pytest.fixture
def roverlink(start: Start, domain: int) -> Start:
    """Starts roverlink commands with `dds`, on loopback, in the domain of the test."""

    def begin(*arguments: object, distribution: str = "humble") -> Program:
        command, *others = arguments
        words = (command, "--middleware", "dds", *others)
        return start(*words, ROS_DOMAIN_ID=str(domain), ROS_LOCALHOST_ONLY="1", ROS_DISTRO=distribution)

    return begin


@dataclass(frozen=True)
class RunningBridge:
    """A bridge, and what its boards would send and receive with."""

    port: int
    board: socket.socket

    def receive(self, **payload: Any) -> None:
        """Send it an envelope, as a board would."""
        self.board.sendto(REGISTRY.envelope(**payload).SerializeToString(), ("127.0.0.1", self.port))


@pytest.fixture
def bridge(roverlink: Start) -> Iterator[Callable[..., RunningBridge]]:
    """Starts the node udp_forwarder, as it is started on a rover, with ports of its own."""
    with contextlib.ExitStack() as opened:

        def begin(distribution: str = "humble") -> RunningBridge:
            board, base = (opened.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) for _ in range(2))
            ports = {"listen_port": 0}
            for name, peer in (("dst_b_port", board), ("dst_a_port", base)):
                peer.bind(("127.0.0.1", 0))
                peer.settimeout(PATIENCE_S)
                ports[name] = peer.getsockname()[1]
            parameters = [word for name, value in ports.items() for word in ("-p", f"{name}:={value}")]
            running = roverlink("run", "--ros-args", *parameters, distribution=distribution)
            return RunningBridge(int(running.wait_for("on UDP port ").rpartition(" ")[2]), board)

        yield begin


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


def answer(child: Peer, ask: Callable[[], None]) -> str:
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


@pytest.mark.slow
def test_datagrams_reach_fast_dds_as_ros_serializes_them(
    fast_dds: Callable[..., Peer], bridge: Callable[..., RunningBridge], types: Typestore
) -> None:
    """What a board sends by UDP arrives at a Fast DDS reader in order, byte for byte as ROS 2 has it."""
    state = types.types["comms/msg/SensorState"]
    forwarder, reader = bridge(), fast_dds("subscribe", "/imu_data", IMU, 10_000)
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


@pytest.mark.slow
def test_what_fast_dds_publishes_is_sent_to_the_board(
    fast_dds: Callable[..., Peer], bridge: Callable[..., RunningBridge], types: Typestore
) -> None:
    """A message that Fast DDS publishes is acknowledged, and arrives by UDP in an envelope as payload number 9."""
    values = {"distance_to_go": 1.5, "turning_radius": -2.25}
    stops = {  # of every command, until its topic speaks
        REGISTRY.envelope(drive_motor={"distance_to_go": 0.0}).SerializeToString(),
        REGISTRY.envelope(arm_ctrl={}).SerializeToString(),
    }
    forwarder = bridge()
    writer = fast_dds("publish", "/drive_motor", MOTOR, serialized(types, MOTOR, **values).hex(), 3)
    datagram = next(datagram for datagram in iter(lambda: forwarder.board.recv(2048), b"") if datagram not in stops)
    assert writer.succeeds()
    assert datagram[0] == 9 << 3 | 2  # protobuf's tag of field 9, a message
    assert REGISTRY.envelope.FromString(datagram) == REGISTRY.envelope(drive_motor=values)


@pytest.mark.slow
@pytest.mark.parametrize(("distribution", "gid_size"), [("humble", 24), ("jazzy", 16)])
def test_the_bridge_is_a_node_with_all_endpoints(
    fast_dds: Callable[..., Peer], bridge: Callable[..., RunningBridge], distribution: str, gid_size: int
) -> None:
    """From ros_discovery_info, Fast DDS knows the endpoints of the node: one a topic, /diagnostics, and /rosout."""
    store = get_typestore(Stores.EMPTY)
    for name, text in _GRAPH.items():
        store.register(get_types_from_msg(text.format(gid_size), f"rmw_dds_common/msg/{name}"))
    endpoints: dict[str, tuple[str, str]] = {}
    node: Any = None
    bridge(distribution)
    graph = fast_dds("graph")
    while node is None or not endpoints.keys() >= {*map(_gid, node.reader_gid_seq), *map(_gid, node.writer_gid_seq)}:
        found = json.loads(graph.line())
        if found["kind"] == "nodes":
            sample = bytes.fromhex(found["sample"])
            (node,) = store.deserialize_cdr(sample, "rmw_dds_common/msg/ParticipantEntitiesInfo").node_entities_info_seq
        else:
            endpoints[found["gid"].ljust(2 * gid_size, "0")] = (found["topic"], found["type"])
    assert (node.node_namespace, node.node_name) == ("/", "udp_forwarder")
    handlers = [*REGISTRY.handlers, *REGISTRY.extra_topics]
    inbound, outbound = ([h for h in handlers if h.route.inbound == wanted] for wanted in (True, False))
    diagnostics = ("rt/diagnostics", "diagnostic_msgs::msg::dds_::DiagnosticArray_")
    log = ("rt/rosout", "rcl_interfaces::msg::dds_::Log_")
    writers, readers = (
        sorted(endpoints[_gid(one)] for one in gids) for gids in (node.writer_gid_seq, node.reader_gid_seq)
    )
    assert writers == sorted([*map(dds_names, inbound), diagnostics, log])
    assert readers == sorted(map(dds_names, outbound))


_GRAPH = {
    "Gid": "uint8[{}] data",
    "NodeEntitiesInfo": """string<=256 node_namespace
string<=256 node_name
rmw_dds_common/Gid[] reader_gid_seq
rmw_dds_common/Gid[] writer_gid_seq""",
    "ParticipantEntitiesInfo": "rmw_dds_common/Gid gid\nrmw_dds_common/NodeEntitiesInfo[] node_entities_info_seq",
}


def _gid(gid: Any) -> str:
    return bytes(gid.data).hex()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "message_type", "values", "options"),
    [
        ("drive_motor", MOTOR, {"distance_to_go": 1.5, "turning_radius": -2.25}, ()),
        ("chatter", STRING, {"data": "Grüße"}, ("--type", STRING)),
    ],
    ids=["of a row", "of a standard type"],
)
def test_echo_and_pub_talk_with_fast_dds(
    fast_dds: Callable[..., Peer],
    roverlink: Start,
    types: Typestore,
    name: str,
    message_type: str,
    values: dict[str, Any],
    options: tuple[str, ...],
) -> None:
    """One prints what Fast DDS publishes, the other publishes what ROS 2 would; both exit with 0."""
    expected = serialized(types, message_type, **values)
    echo = roverlink("echo", name, *options, "--json", "--count", "1")
    writer = fast_dds("publish", f"/{name}", message_type, expected.hex(), 2)
    assert echo.end() == 0
    assert json.loads(echo.output[0]) == values
    writer.close()
    reader = fast_dds("subscribe", f"/{name}", message_type, 1)
    pub = roverlink("pub", name, json.dumps(values), *options, "--once", "--wait", PATIENCE_S)
    assert without_slack(reader.line(), expected) == expected
    assert reader.succeeds()
    assert pub.end() == 0
