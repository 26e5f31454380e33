"""Run the bridge with simulated boards and a simulated basestation, and show the traffic live.

Run the bridge with simulated boards, a simulated basestation and a ROS 2 node on this computer, to see what
roverlink does without a rover. No message leaves this computer. If roverkit is installed, a simulated rover
drives as the messages on drive_motor say; its wheels slip, and its boards measure. With OpenCV, the images
of its camera are rendered, and its position is computed from the markers in them. With ONNX Runtime,
another camera detects the parts of a rendered panel. With PyAV, a page in the browser shows the video of
the rover's camera, as it arrives at the basestation, and a map with the true path of the rover, the path
that its camera gives, and that of its wheel odometry.

The live table has a row for each message of mapping.yaml: its number, its direction, messages a second,
messages since the start, and the last value. The last lines say how many of these messages were bridged,
and what the bridge counted. Exit code 0: each message of mapping.yaml was bridged at least once; 1: one or
more were not.

Example: roverlink demo --seconds 5
"""

from __future__ import annotations

import argparse
import contextlib
import importlib.util
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from roverlink import topic_types
from roverlink.console import (
    FINDINGS,
    OK,
    Subparsers,
    add_project,
    documented_command,
    isolate_ros,
    project_folder,
    seconds,
)
from roverlink.generated_code import load_project
from roverlink.generator.example_payloads import payload_at
from roverlink.installed_packages import entry_points
from roverlink.numerals import counted
from roverlink.runtime import Registry
from roverlink.runtime.client import BlockingPeer, Received
from roverlink.runtime.core import cdr
from roverlink.runtime.middleware import Middleware
from roverlink.runtime.text.values import message_to_values, payload_to_values
from roverlink.simulation import crossings
from roverlink.simulation.bridge_host import MIDDLEWARES, bridge_with
from roverlink.simulation.crossings import Crossing
from roverlink.simulation.demo_parts import ENTRY_POINTS, STEP_NS, DemoPart, DemoSetting, OpenParts
from roverlink.simulation.pace import Pace
from roverlink.simulation.peers import on_loopback
from roverlink.simulation.simulated_keys import make_throw_away_keys
from roverlink.simulation.simulated_nodes import SimulatedNodes

if TYPE_CHECKING:
    from rich.console import Console

_RATE_HZ = 20.0
_REFRESH_HZ = 4
_PLAIN_REPORT_S = 5.0
_SHOWN_COUNTERS = ("received", "published", "sent", "forwarded", "dropped", "kernel_drops")


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = documented_command(commands, __name__, __doc__)
    add_project(parser)
    parser.add_argument(
        "--seconds", type=seconds, default=15.0, metavar="S", help="stop after S seconds (default: %(default)s)"
    )
    parser.add_argument(
        "--middleware",
        choices=MIDDLEWARES,
        default="dds" if importlib.util.find_spec("cyclonedds") else "memory",
        help="connection between the bridge and the ROS 2 node. dds, rclpy: the bridge is a separate process in ROS 2; "
        "memory: bridge and node run in one process, without ROS 2 (default: %(default)s)",
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Run the bridge with simulated peers, and show its traffic. The exit code is 1 if a row had no bridged message."""
    from rich.console import Console  # here: --help needs no rich

    project = project_folder(arguments.project)
    registry = load_project(project)
    console = Console()
    with contextlib.ExitStack() as stack:
        # The demo's messages must not reach a real rover in the same network.
        isolate_ros(stack)
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="roverlink-demo-")))
        say = partial(console.print, soft_wrap=True, markup=False)
        setting = DemoSetting(project, registry, arguments.middleware, folder, say)
        parts = [part for open_parts in _extensions() for part in open_parts(setting, stack)]
        keys = make_throw_away_keys(registry, folder)
        peers = {peer.name: stack.enter_context(_on_loopback(peer.name, registry, keys)) for peer in registry.peers}
        given = on_loopback(registry, {name: peers[name.peer].port for name in registry.ends})
        host = bridge_with(arguments.middleware, project, registry, given, key_files=[*keys.values()])
        stack.enter_context(host)
        for peer in peers.values():
            peer.direct_to("127.0.0.1", host.port)
        middleware = stack.enter_context(host.middleware(topic_types.identity("demo")))
        rig = _Rig(registry, middleware, peers, parts)
        _show(rig, console, arguments.seconds, f"roverlink over {arguments.middleware}")
        account = host.stop()  # at once: the commanding topics are silent from now on, and the watchdogs would fire
        for part in parts:
            say(part.stop())
    missing = [crossing.handler.route.name for crossing in rig.crossings if not crossing.count]
    crossed = sum(crossing.count for crossing in rig.crossings)
    console.print(
        f"{len(rig.crossings) - len(missing)} of {counted(len(rig.crossings), 'message')} bridged, "
        f"{counted(crossed, 'time')} in all; {counted(rig.forwarded, 'datagram')} forwarded unchanged from one peer to "
        "another"
    )
    counters = ", ".join(f"{name} {account[name]}" for name in _SHOWN_COUNTERS)
    console.print(f"counters of the bridge: {counters}", soft_wrap=True)
    if missing:
        console.print(f"[red]not bridged: {', '.join(missing)}")
    return FINDINGS if missing else OK


def _extensions() -> Iterator[OpenParts]:
    """Yield the functions of installed packages that add parts to the demo."""
    for entry in entry_points(ENTRY_POINTS):
        yield entry.load()


def _on_loopback(peer: str, registry: Registry, keys: Mapping[str, Path]) -> BlockingPeer:
    files = [keys[peer]] if peer in keys else []
    return BlockingPeer.open(peer, registry=registry, local_address="127.0.0.1", local_port=0, key_files=files)


class _Rig:
    """Simulated boards, simulated basestation and a ROS 2 node, which exchange messages through the bridge."""

    def __init__(
        self,
        registry: Registry,
        middleware: Middleware,
        peers: dict[str, BlockingPeer],
        parts: Sequence[DemoPart],
    ) -> None:
        """Create the ROS 2 publishers and subscribers.

        ``peers`` holds a program in place of each peer with all its boards. This object sends example values for all
        rows but those of the ``parts``.
        """
        self._peers, self._parts = peers, parts
        elsewhere = {row for part in parts for row in part.rows}
        self._inbound = [
            handler for handler in registry.handlers if handler.route.inbound and handler.route.name not in elsewhere
        ]
        self._nodes = SimulatedNodes(registry, middleware, elsewhere)
        self.crossings = [Crossing(handler) for handler in registry.handlers]
        self.forwarded = 0
        self._by_number = {crossing.handler.route.number: crossing for crossing in self.crossings}
        for crossing in self.crossings:
            if crossing.handler.route.inbound:
                _subscribe(crossing, middleware)
        for part in parts:
            part.join(middleware)

    def send(self, seconds: float) -> None:
        """Send one datagram for each row that comes from a peer; publish one message for each row that goes to a peer.

        The values in the messages depend on ``seconds``, the time since the start. The messages of the parts are not
        among them; see `step`.
        """
        for handler in self._inbound:
            self._peers[handler.route.peer].send(payload_at(handler.payload_type, seconds), handler.route.name)
        self._nodes.publish(seconds)

    def step(self) -> None:
        """Read the payloads that have arrived, and advance the time of the parts by a step.

        Payloads at the simulated peers are counted by row, or as forwarded.
        """
        for name, peer in self._peers.items():
            for received in peer.arrived():
                self._take(name, received)
        for part in self._parts:
            part.step(self._peers)

    def _take(self, peer: str, received: Received) -> None:
        for part in self._parts:
            part.receive(peer, received)
        crossing = self._by_number.get(received.number)
        if crossing is None:
            return  # a link message of the bridge
        if crossing.handler.route.inbound:
            self.forwarded += 1
        else:
            crossing.add(partial(payload_to_values, received.payload))


def _subscribe(crossing: Crossing, middleware: Middleware) -> None:
    """Count the messages on the topic of a row that comes from a peer."""
    handler = crossing.handler

    def values(data: bytes) -> dict[str, Any]:
        return message_to_values(cdr.decode(handler.message_type, data))

    def seen(messages: Sequence[bytes]) -> None:
        for data in messages:
            crossing.add(partial(values, data))

    topic = topic_types.full_topic(handler.route.topic)
    middleware.subscribe(topic, handler.message_type, handler.route.qos, seen)


def _show(rig: _Rig, console: Console, seconds: float, title: str) -> None:
    from rich.live import Live

    pace, steps = Pace(1.0, lambda _: console.print("this computer is too slow: the simulated time has paused")), 0
    start = time.monotonic()
    next_send = next_report = start
    with Live(console=console, refresh_per_second=_REFRESH_HZ, auto_refresh=False) as live:
        while (now := time.monotonic()) < start + seconds:
            if now >= next_send:
                next_send += 1 / _RATE_HZ
                rig.send(now - start)
            rig.step()
            if now >= next_report:
                next_report += 1 / _REFRESH_HZ if console.is_terminal else _PLAIN_REPORT_S
                if console.is_terminal:
                    live.update(
                        crossings.table(rig.crossings, f"{title}, {seconds - (now - start):.0f} s left"), refresh=True
                    )
                else:
                    crossed = sum(bool(crossing.count) for crossing in rig.crossings)
                    of = counted(len(rig.crossings), "message")
                    console.print(f"{now - start:4.0f} s: {crossed} of {of} bridged")
            steps += 1
            pace.wait(steps * STEP_NS)
        live.update(crossings.table(rig.crossings, title), refresh=True)
    if not console.is_terminal:
        console.print()  # outside a terminal, the last table ends without a line break
