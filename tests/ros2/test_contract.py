"""The contract in docs/architecture.md: what each fault does to `roverlink run`, over each middleware alike."""

from __future__ import annotations

import os
import pkgutil
import signal
import socket
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from importlib.util import find_spec
from types import SimpleNamespace
from typing import Any

import pytest
from command_fixtures import called, own_signals, peer
from needs import NO_DDS, NO_FOXGLOVE, NO_RCLPY, NO_ZENOH
from polling import wait_until
from programs import Start
from running import Called

from generated.messages import ImuSensorInformation
from generated.registry import REGISTRY
from roverlink.runtime import Qos
from roverlink.runtime.core import cdr
from roverlink.runtime.interfaces.diagnostic_msgs import DiagnosticArray
from roverlink.runtime.middleware import NodeIdentity, open_middleware
from roverlink.runtime.ros_time.clock import SYSTEM_CLOCK

__all__ = ["called", "own_signals", "peer"]

_IMU = REGISTRY.envelope(imu_info={}).SerializeToString()
_DRIVE = REGISTRY.by_name["drive_motor"]
_YEARS_NS = 20 * 365 * 24 * 3600 * 10**9
_STOPS = 3


_PACKAGES = {"dds": ("cyclonedds", NO_DDS), "rclpy": ("rclpy", NO_RCLPY), "zenoh": ("zenoh", NO_ZENOH)}


@pytest.fixture(params=_PACKAGES, autouse=True)
def middleware(request: pytest.FixtureRequest, environment: dict[str, str]) -> str:
    """Each middleware that is installed; zenoh with a router."""
    name = str(request.param)
    package, reason = _PACKAGES[name]
    if not find_spec(package):
        pytest.skip(reason)
    if name == "zenoh":
        request.getfixturevalue("zenoh_router")
    return name


@pytest.fixture
def others(middleware: str) -> str:
    """The middleware of the nodes that the bridge meets: that of rclpy is DDS."""
    return "zenoh" if middleware == "zenoh" else "dds"


Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def run(
    called: Called, middleware: str, others: str, peer: socket.socket, free_udp_ports: Sequence[int]
) -> Iterator[Run]:
    """Runs a bridge in this process, as a terminal does, while datagrams and commands come: code, output and errors.

    ``running`` is called each time that the basestation has heard the bridge. The signal comes as soon as the result is
    true, unless a fault has ended the bridge before.
    """
    with socket.socket(type=socket.SOCK_DGRAM) as basestation:
        basestation.bind(("127.0.0.1", 0))
        basestation.settimeout(0.02)
        listen_port, dst_b_port, dst_a_port = free_udp_ports[0], peer.getsockname()[1], basestation.getsockname()[1]
        ports = {"listen_port": listen_port, "dst_b_port": dst_b_port, "dst_a_port": dst_a_port}
        words = [word for name, port in ports.items() for word in ("-p", f"{name}:={port}")]
        bridge = ("127.0.0.1", listen_port)

        def run(*options: str, running: Callable[[], object] = lambda: True, number: int = signal.SIGTERM) -> Any:
            ended = threading.Event()

            def drive() -> None:
                with open_middleware(others, NodeIdentity("commander")) as commander:
                    commands = commander.publisher(f"/{_DRIVE.route.topic}", _DRIVE.message_type, Qos())
                    while not ended.wait(0.03):
                        for datagram in (_IMU, b"\xff"):
                            basestation.sendto(datagram, bridge)
                        commands.publish([_DRIVE.to_cdr(_DRIVE.payload_type(distance_to_go=1.5))])
                        with suppress(OSError):  # not yet
                            if basestation.recv(2048) and running():
                                _last_stops(peer)  # those of a silence, if a thread has hung for half a second
                                os.kill(os.getpid(), number)
                                ended.wait()

            driver = threading.Thread(target=drive)
            driver.start()
            try:
                return called("run", "--middleware", middleware, *options, "--ros-args", *words)
            finally:
                ended.set()
                driver.join()

        yield run


def _last_stops(peer: socket.socket) -> int:
    """How often the drive board was told to stop after its last command, in the datagrams that wait in its socket."""
    peer.setblocking(False)
    stops = 0
    with suppress(BlockingIOError):
        while True:
            envelope: Any = REGISTRY.envelope.FromString(peer.recv(2048))
            if envelope.WhichOneof(REGISTRY.oneof) == _DRIVE.route.name:
                stops = 0 if envelope.drive_motor.distance_to_go else stops + 1
    return stops


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGQUIT])
def test_any_ending_signal_stops_the_rover(run: Run, peer: socket.socket, number: signal.Signals) -> None:
    """The stop goes out three times, and the account is told. A SIGHUP that nohup ignores ends nothing.

    The commands end with the signal, so a computer that takes half a second for the end sends the stop of a silence.
    """
    if number != signal.SIGHUP:
        signal.signal(signal.SIGHUP, signal.SIG_IGN)
    code, output, errors = run("--json", number=number, running=lambda: os.kill(os.getpid(), signal.SIGHUP) is None)
    assert code == 0, errors
    assert _last_stops(peer) in (_STOPS, _STOPS + 1)
    assert '"received":' in output
    assert ": received " in errors.splitlines()[-1]


_ENDS = "roverlink: the program ends because its thread {} failed: TypeError: a bug (ROVERLINK_DEBUG=1 shows where)"
_PYTHON = ("--ros-args", "-p", "native_core:=false", "--")
_GOES_ON = "the thread {} goes on after TypeError('a bug')"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("where", "options", "said"),
    [
        ("runtime.core.translator.Translator.receive_all", (), _ENDS.format("udp-receive")),
        ("runtime.bridge.to_peer.OutboundRow.run_due", (), _ENDS.format("timekeeper")),
        ("runtime.bridge.qos_watch.QosWatch.run_due", (), _ENDS.format("graph-watch")),
        ("runtime.middleware.{}.serve", _PYTHON, _ENDS.format("{}-take")),
        ("runtime.middleware.{}.serve", _PYTHON, "the thread {}-take hangs, so the node does not leave ROS 2"),
        ("runtime.monitoring.liveness.SilenceLog.take", (), _GOES_ON.format("monitor")),
        ("link_page.live_page.LivePage.tick", ("--page", "0"), _GOES_ON.format("page")),
        ("runtime.middleware.rosout.Log.__init__", (), ": received "),
    ],
)
@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")  # the thread of the commander
def test_no_thread_dies_alone(
    run: Run,
    peer: socket.socket,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
    middleware: str,
    where: str,
    options: tuple[str, ...],
    said: str,
) -> None:
    """A thread goes on after an error, or the program ends with code 2 and the stops; the account is told."""
    running, raised, over = threading.Event(), threading.Event(), threading.Event()
    part = f"roverlink.{where.format({'rclpy': 'rclpy_receiving'}.get(middleware, middleware))}"
    original: Any = pkgutil.resolve_name(part)

    def fail(*given: object, **named: object) -> object:
        if not running.is_set():
            return original(*given, **named)
        raised.set()
        if "hangs" in said:
            over.wait()
        raise TypeError("a bug")

    monkeypatch.setattr(part, fail)
    code, _, errors = run(*options, running=lambda: running.set() or raised.is_set())  # type: ignore[func-returns-value]
    over.set()
    for thread in threading.enumerate():
        if thread.name.endswith("-take"):  # it raises its error now, not in the next test
            thread.join()
    lines = [*caplog.text.splitlines(), *errors.splitlines()]
    assert code == (2 if said.startswith("roverlink") else 0), errors
    assert any(said.format(middleware) in line for line in lines), errors
    assert any(": received " in line for line in lines[-2:]), errors
    assert _last_stops(peer) >= _STOPS  # and those of a silence before the end, on a busy computer


@pytest.mark.slow
def test_a_clock_beyond_2038_ends_nothing(run: Run, others: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The stamps show the last second that ROS 2 has; /diagnostics goes on, and after the clock is right again too."""
    stamps: list[int] = []
    wall, ahead = time.time_ns, [0]
    for clock, name in ((time, "time_ns"), (SYSTEM_CLOCK, "now")):
        monkeypatch.setattr(clock, name, lambda: wall() + ahead[0])

    def hear(messages: Sequence[bytes]) -> None:
        stamps.extend(cdr.decode(DiagnosticArray, message).header.stamp.sec for message in messages)
        ahead[0] = 0 if 2**31 - 1 in stamps else _YEARS_NS

    with open_middleware(others, NodeIdentity("judge")) as judge:
        judge.subscribe("/diagnostics", DiagnosticArray, Qos(), hear)
        code, _, errors = run(running=lambda: 2**31 - 1 in stamps[:-1])
    assert code == 0
    assert "goes on" not in errors
    assert stamps[-1] < 2**31 - 1


@pytest.mark.slow
def test_a_frozen_subscriber_ends_nothing(start: Start, middleware: str) -> None:
    """With `keep_all`, what the publisher would have to wait for is not accepted, and no error is raised.

    Zenoh drops it, and does not tell.
    """
    with open_middleware(middleware, NodeIdentity("bridge")) as ours:
        publisher = ours.publisher("/imu_data", ImuSensorInformation, Qos(history="keep_all"))
        echo = start("echo", "imu_data", "--middleware", middleware)
        wait_until(publisher.has_subscribers, "a subscriber")
        echo.send_signal(signal.SIGSTOP)
        message = [cdr.encode(ImuSensorInformation())]
        accepted = sum(publisher.publish(message) for _ in range(20_000))
        assert 0 < accepted < 20_000 or (accepted == 20_000 and middleware == "zenoh")


def test_a_viewer_that_does_not_read_holds_up_nothing(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    """The SDK's server waits for it without end, and the bridge does not."""
    foxglove = pytest.importorskip("foxglove", reason=NO_FOXGLOVE)
    never = threading.Event()
    monkeypatch.setattr(foxglove, "start_server", lambda **_: SimpleNamespace(port=1, stop=never.wait))
    assert run("--foxglove", "0")[0] == 0


@pytest.mark.slow
def test_a_domain_that_cannot_be_is_one_line(called: Called, monkeypatch: pytest.MonkeyPatch, middleware: str) -> None:
    """Every command that speaks ROS 2 quotes a wrong ROS_DOMAIN_ID, and says what it may be."""
    for text in ("233", "-1", "1.5", "0x1", "010", "rover"):
        monkeypatch.setenv("ROS_DOMAIN_ID", text)
        said = f"roverlink: ROS_DOMAIN_ID is '{text}'; set it to a number from 0 to 232"
        assert called("echo", "imu_data", "--middleware", middleware) == (2, "", said)
    for command in ("run", "top --once", "pub imu_data {}", "demo --seconds 1"):
        assert called(*command.split(), "--middleware", middleware) == (2, "", said)
    assert called("simulate", "--bridge", middleware, "--seconds", "1") == (2, "", said)
    assert said.removeprefix("roverlink: ") in called("doctor")[1]
