"""Section `watching`: CPU cost of recording and of Foxglove on the thread of a bridge that receives datagrams."""

import logging
import math
import tempfile
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, ExitStack, contextmanager
from pathlib import Path
from typing import NamedTuple

from bench.errors import BenchError
from bench.lab import Lab
from bench.result import Group, SectionResult, Table
from bench.wire import IMU_STAMP, imu_datagram
from generated.registry import REGISTRY
from roverlink.console import isolate_ros
from roverlink.runtime import Bridge, RoverlinkError
from roverlink.runtime.bridge.bridge import Observer
from roverlink.runtime.middleware import Middleware, NodeIdentity, open_middleware
from roverlink.runtime.middleware.tapping import TappedMiddleware
from roverlink.runtime.monitoring.foxglove_server import FoxgloveServer
from roverlink.runtime.recording.datagram_tap import DatagramTap
from roverlink.runtime.recording.recorder import Recorder
from roverlink.runtime.ros_arguments import parameters
from roverlink.simulation.peers import Arrivals

RATE = 5_000  # datagrams a second; far more than a rover has, and no more than two busy cores handle
ROUNDS, WARM_UP_SECONDS = 5, 0.2

NOTE = (
    f"CPU time of the receiving thread per datagram, at {RATE:,} a second. Other threads write the file and serve"
    " viewers. What is off costs nothing: it is not in the call chain."
)


class Watcher(NamedTuple):
    """Observer of a bridge, and the number of messages that it has lost."""

    middleware: Middleware
    observers: Sequence[Observer] = ()
    lost: Callable[[], int] = lambda: 0


def measure(lab: Lab) -> SectionResult:
    """Let a bridge receive with each watcher, with the native core and without it."""
    groups, data = [], []
    for native in (True, False):
        rows, alone, heading = [], None, ""
        for name, watched in WATCHERS.items():
            try:
                heading, own, lost = _cost(lab, watched, native)
            except (RoverlinkError, BenchError) as error:
                lab.say(f"{name} is left out: {error}")
                continue
            lab.say(f"{name:>20} {own:.2f} us")
            alone = own if alone is None else alone
            rows.append((name, f"{own:.2f}", f"{own - alone:.2f}", str(lost)))
            data.append({"watcher": name, "native": native, "us": own, "lost": lost})
        groups.append(Group(heading, rows))
    table = Table("Watching a bridge", ("", "us per datagram", "+us", "lost"), groups, [NOTE])
    return SectionResult([table], data={"costs": data})


def _cost(
    lab: Lab, watched: Callable[[Middleware], AbstractContextManager[Watcher]], native: bool
) -> tuple[str, float, int]:
    """Return the way that the bridge takes, CPU microseconds of its receiving thread per datagram, and losses."""
    with ExitStack() as stack:
        isolate_ros(stack)
        given = stack.enter_context(Arrivals(REGISTRY)).parameters | {"listen_port": 0, "native_core": native}
        watcher = stack.enter_context(watched(open_middleware("dds", NodeIdentity("bench"))))
        settings, logger = parameters.read(REGISTRY, given), logging.getLogger("bench")
        bridge = Bridge(REGISTRY, settings, watcher.middleware, lambda topic: f"/{topic}", logger, watcher.observers)
        others = {*threading.enumerate()}
        stack.enter_context(bridge)
        thread = next(one for one in {*threading.enumerate()} - others if one.name == "udp-receive")
        udp = ("udp", bridge.port, imu_datagram().hex(), IMU_STAMP.high, IMU_STAMP.low)
        load = stack.enter_context(lab.tool("load", *udp))
        clock = time.pthread_getcpuclockid(thread.ident or 0)
        load.ask(f"{RATE} {WARM_UP_SECONDS}")
        fastest = math.inf  # of some rounds, because other programs only ever make a round slower
        for _ in range(ROUNDS):
            before, received = time.clock_gettime(clock), bridge.account.received
            load.ask(f"{RATE} {lab.seconds}")
            spent, received = time.clock_gettime(clock) - before, bridge.account.received - received
            fastest = min(fastest, spent / received)
        bridge.stop()
        bridge.run()
        return bridge.way, fastest * 1e6, watcher.lost()


@contextmanager
def _nothing(middleware: Middleware) -> Iterator[Watcher]:
    yield Watcher(middleware)


@contextmanager
def _recorder(middleware: Middleware) -> Iterator[Watcher]:
    with tempfile.TemporaryDirectory() as folder:
        recorder = Recorder(Path(folder) / "run.mcap", REGISTRY, {}, logging.getLogger("bench"))
        taps = DatagramTap(recorder, REGISTRY)
        with recorder:
            yield Watcher(TappedMiddleware(middleware, recorder), [taps], lambda: recorder.lost)


@contextmanager
def _foxglove(middleware: Middleware) -> Iterator[Watcher]:
    with FoxgloveServer("bench", "127.0.0.1", 0) as server:
        yield Watcher(TappedMiddleware(middleware, server))


WATCHERS = {"nothing": _nothing, "recorder": _recorder, "Foxglove, no viewer": _foxglove}
