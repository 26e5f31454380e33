"""Section `starting`: the time from the start of a bridge to its first bridged datagram, and its memory."""

import contextlib
import socket
import statistics
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass

from bench.contestants import Contestant, Ports
from bench.lab import Lab
from bench.process import START_SECONDS
from bench.result import Group, SectionResult, Table
from bench.rig import free_port
from bench.wire import imu_datagram

ROUNDS, QUICK_ROUNDS = 5, 1
INTERVAL_S = 0.002
WARM_DATAGRAMS = 1000

NOTE = (
    "Median. A datagram is bridged when its forward arrives, which each bridge sends beside publishing. Memory: of the"
    f" whole process (RSS), {WARM_DATAGRAMS:,} datagrams later."
)


@dataclass(frozen=True, slots=True)
class Start:
    """Seconds until the first datagram was bridged, and megabytes after some more."""

    contestant: str
    seconds: float
    megabytes: float


def measure(lab: Lab) -> SectionResult:
    """Start every bridge a few times, in turn."""
    bridges = [contestant for contestant in lab.contestants if contestant.bridges]
    rounds = QUICK_ROUNDS if lab.quick else ROUNDS
    found = [_start(lab, contestant) for _ in range(rounds) for contestant in bridges]
    rows, medians = [], []
    for name in dict.fromkeys(start.contestant for start in found):
        own = [start for start in found if start.contestant == name]
        seconds = statistics.median(start.seconds for start in own)
        megabytes = statistics.median(start.megabytes for start in own)
        medians.append(Start(name, seconds, megabytes))
        lab.say(f"{name:>20} bridges after {seconds * 1e3:.0f} ms, with {megabytes:.0f} MB")
        rows.append((name, f"{seconds * 1e3:.0f}", f"{megabytes:.0f}"))
    table = Table("Start and memory", ("", "ms to the first datagram", "MB"), [Group("", rows)], [NOTE])
    return SectionResult([table], data={"starts": [*map(asdict, medians)]})


def _start(lab: Lab, contestant: Contestant) -> Start:
    with contextlib.ExitStack() as stack:
        arrivals, other, sender = (stack.enter_context(one) for one in _sockets(3))
        ports = Ports(free_port(), arrivals.getsockname()[1], other.getsockname()[1])
        arrivals.settimeout(INTERVAL_S)
        began = time.monotonic()
        child = stack.enter_context(lab.start(contestant, contestant.command(ports, True)))
        while not _bridges(sender, ports.listen, arrivals):
            child.check_running()
            if time.monotonic() > began + START_SECONDS:
                raise child.failure(f"bridged no datagram within {START_SECONDS:g} s")
        seconds = time.monotonic() - began
        for _ in range(WARM_DATAGRAMS):
            _bridges(sender, ports.listen, arrivals)
        start = Start(contestant.name, seconds, child.resident_mb())
        child.stop()
        return start


def _sockets(count: int) -> Iterator[socket.socket]:
    for _ in range(count):
        made = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        made.bind(("127.0.0.1", 0))
        yield made


def _bridges(sender: socket.socket, port: int, arrivals: socket.socket) -> bool:
    """Send a datagram, and return true if one arrives within the interval."""
    sender.sendto(imu_datagram(), ("127.0.0.1", port))
    with contextlib.suppress(TimeoutError):
        return bool(arrivals.recv(2048))
    return False
