"""One measurement: a bridge, load on one side of it, an observer or sinks on the other."""

import contextlib
import random
import socket
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from typing import Any

from bench.contestants import Contestant, Ports
from bench.errors import BenchError
from bench.lab import Lab
from bench.process import QUIET_SECONDS, Child, udp_socket, wait_until_bound, wait_until_quiet
from bench.wire import IMU_STAMP, MOTOR_STAMP, imu_datagram

WARM_UP_RATE = 1000
WARM_UP_SECONDS = 0.2
SETTLING_SECONDS = 3.0  # in which a bridge still learns of other nodes, which counts where datagrams are few
MATCH_SECONDS = 20.0
PACE_KEPT = 0.95
_PORTS = range(20_000, 32_768)


@dataclass(frozen=True, slots=True)
class Setting:
    """Way to run the bridge.

    `observed` adds a subscriber to the published topic; the outbound direction is always observed. With `rclpy`, the
    ROS 2 side is rclpy instead of Cyclone DDS.
    """

    name: str
    heading: str
    outbound: bool = False
    observed: bool = False
    forwards: bool = False
    rclpy: bool = False


@dataclass(frozen=True, slots=True)
class Offered:
    """Answer of the load: the number sent, and the time it took."""

    sent: int
    seconds: float


@dataclass(frozen=True, slots=True)
class Point:
    """Result of one contestant with one load.

    `rate` is the requested load per second; None means a flood.
    """

    setting: str
    contestant: str
    rate: float | None
    sent: int
    sending_seconds: float
    delivered: int
    seconds: float  # from the first datagram until all programs were idle
    cpu_seconds: float
    kernel_drops: int  # at the bridge's socket, because its buffer was full
    p50_us: float | None
    p99_us: float | None

    @property
    def offered_per_second(self) -> float:
        """Rate that the load really sent."""
        return self.sent / self.sending_seconds

    @property
    def delivered_per_second(self) -> float:
        """Rate that came out at the other end."""
        return self.delivered / self.seconds

    @property
    def cpu_us(self) -> float:
        """CPU time of the bridge's process per datagram that came out, in microseconds, kernel included."""
        return self.cpu_seconds / self.delivered * 1e6 if self.delivered else float("nan")

    @property
    def lost(self) -> int:
        """Number of datagrams that did not come out."""
        return self.sent - self.delivered

    @property
    def kept_up(self) -> bool:
        """True if load and bridge kept the pace; a bridge that finishes long after the load cannot sustain it."""
        behind = self.seconds - self.sending_seconds
        on_pace = self.rate is not None and self.offered_per_second >= self.rate * PACE_KEPT
        return on_pace and behind <= (1 - PACE_KEPT) * self.sending_seconds + QUIET_SECONDS

    @property
    def lossless(self) -> bool:
        """True if everything came out at the pace at which it came in."""
        return self.lost == 0 and self.kept_up


@dataclass(frozen=True, slots=True)
class Rig:
    """Environment of a bridge in one setting, used for many bridges in turn."""

    lab: Lab
    setting: Setting
    ports: Ports
    load: Child
    observer: Child | None

    def measure(self, contestant: Contestant, rate: float | None, seconds: float) -> Point:
        """Start the bridge, warm it up, send the load, and wait until everything is idle."""
        command = contestant.command(self.ports, self.setting.forwards)
        with self.lab.start(contestant, command) as child:
            wait_until_bound(child, self.ports.listen)
            warmed = self._warm_up(child, WARM_UP_SECONDS if rate is None or rate > WARM_UP_RATE else SETTLING_SECONDS)
            used, began = child.cpu_seconds(), time.monotonic()
            offered = self._offer(rate, seconds)
            rested = self._rest(child)
            used = child.cpu_seconds() - used
            state = udp_socket(self.ports.listen)
            arrived = self.observer.ask("") if self.observer else None
            counts = child.stop()
        ages: dict[str, Any] = counts if arrived is None else arrived
        return Point(
            setting=self.setting.name,
            contestant=contestant.name,
            rate=rate,
            sent=offered.sent,
            sending_seconds=offered.seconds,
            delivered=contestant.handled(counts) - warmed if arrived is None else arrived["received"],
            seconds=max(rested - began, offered.seconds),
            cpu_seconds=used,
            kernel_drops=state.drops if state else 0,
            p50_us=ages.get("p50_us"),
            p99_us=ages.get("p99_us"),
        )

    def _offer(self, rate: float | None, seconds: float) -> Offered:
        return Offered(**self.load.ask(f"{rate or 0} {seconds}"))

    def _rest(self, child: Child) -> float:
        return wait_until_quiet([child, self.observer] if self.observer else [child], self.ports.listen)

    def _warm_up(self, child: Child, seconds: float) -> int:
        """Send until datagrams pass (DDS needs time to match), and then for some seconds; return the number sent."""
        sent, deadline = 0, time.monotonic() + MATCH_SECONDS
        while self.observer:
            sent += self._offer(WARM_UP_RATE, 0.02).sent
            if self.observer.ask("")["received"]:
                break
            child.check_running()
            if time.monotonic() > deadline:
                raise child.failure(f"did not pass on any message within {MATCH_SECONDS:g} s")
        sent += self._offer(WARM_UP_RATE, seconds).sent
        self._rest(child)
        if self.observer:
            self.observer.ask("")
        return sent


@contextmanager
def open_rig(lab: Lab, setting: Setting) -> Iterator[Rig]:
    """Start load, observer and sinks of a setting."""
    with ExitStack() as stack:
        sinks = [stack.enter_context(_sink()) for _ in range(2)]
        a, b = (sink.getsockname()[1] for sink in sinks)
        listen = free_port()
        if setting.outbound:
            b = free_port()
            load = lab.rclpy_tool("load") if setting.rclpy else lab.tool("load", "dds")
            observer: Child | None = lab.tool("observe", "udp", b, MOTOR_STAMP.high, MOTOR_STAMP.low)
        else:
            load = lab.tool("load", "udp", listen, imu_datagram().hex(), IMU_STAMP.high, IMU_STAMP.low)
            observer = _subscriber(lab, setting) if setting.observed else None
        stack.enter_context(load)
        if observer:
            stack.enter_context(observer)
        yield Rig(lab, setting, Ports(listen, a, b), load, observer)


def _subscriber(lab: Lab, setting: Setting) -> Child:
    return lab.rclpy_tool("observe") if setting.rclpy else lab.tool("observe", "dds")


def _sink() -> socket.socket:
    """Return a bound socket that nobody reads, with the smallest buffer: it stands for another computer.

    Without a socket on the port, each datagram would cause an ICMP error, which costs time.
    """
    sink = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sink.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 0)
    sink.bind(("127.0.0.1", 0))
    return sink


def free_port() -> int:
    """Return a port below those that the system gives to clients: one of these could take it before a bridge starts."""
    for port in random.sample(_PORTS, len(_PORTS)):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe, contextlib.suppress(OSError):
            probe.bind(("127.0.0.1", port))
            return port
    raise BenchError(f"no UDP port from {_PORTS.start} to {_PORTS.stop - 1} is free")
