"""Implementation of ``roverlink simulate-rover``: a rover that drives, in place of the boards of a real one."""

from __future__ import annotations

import argparse
import contextlib
import json
import math
import random
import sys
import time
from collections import Counter
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Protocol

from roverkit.node.camera_outputs import NO_MIDDLEWARE
from roverkit.odometry.odometry_messages import odometry_of
from roverkit.odometry.wheel_odometry import OdometryEstimate
from roverkit.simulation.rover_datagrams import RoverDatagrams
from roverkit.simulation.rover_model import STEP_NS, RoverModel
from roverkit.simulation.simulation_declaration import CAMERA_INFO, CLOCK, IMAGE, NODE, TRUTH

from roverlink import topic_types
from roverlink.console import OK, project_folder
from roverlink.generated_code import load_project
from roverlink.runtime import Registry, SetupError
from roverlink.runtime.client import BlockingPeer, Received
from roverlink.runtime.core import cdr
from roverlink.runtime.interfaces import Time, rosgraph_msgs
from roverlink.runtime.middleware import Middleware, Publisher, open_middleware
from roverlink.runtime.net import udp
from roverlink.runtime.ros_arguments import parameters
from roverlink.runtime.ros_time.headers import header_of
from roverlink.simulation.pace import Pace
from roverlink.simulation.scenarios import SCENARIOS, Emission, Stream, World

if TYPE_CHECKING:
    from roverkit.simulation.rover_camera import RoverCamera

REBOOT = "reboot"
_MAP, _BASE = "map", "base_link"
_TRUTH_NS, _IMAGE_NS = 50_000_000, 500_000_000
_BETWEEN_RESTARTS_S = (5.0, 20.0)
_ZEROS = [[0.0] * 3 for _ in range(3)]

Scenario = Callable[[Stream], Stream]


def simulate_rover(arguments: argparse.Namespace) -> int:
    """Simulate a rover until Ctrl-C, or for ``--seconds`` of its time. The exit code is 0.

    Raises `SetupError` if the table lacks a row, or if an option cannot be used.
    """
    registry = load_project(project_folder(arguments.project))
    datagrams = RoverDatagrams(registry)
    scenarios = _scenarios(arguments.scenario, arguments.seed, registry)
    host, port = udp.destination_of(arguments.to)
    rover = RoverModel(arguments.seed)
    restarts = random.Random(arguments.seed) if REBOOT in arguments.scenario else None  # noqa: S311  # as below
    with contextlib.ExitStack() as stack:
        boards = BlockingPeer.open(
            datagrams.peer,
            registry=registry,
            host=host,
            port=port,
            local_port=arguments.listen,
            key_files=arguments.key_file,
        )
        publish: Callable[[RoverModel], None] | None = None
        if arguments.middleware != NO_MIDDLEWARE:
            middleware = open_middleware(arguments.middleware, topic_types.identity(NODE.name))
            publish = _Publications(stack.enter_context(middleware), arguments).publish
        elif arguments.clock or arguments.landmarks is not None:
            raise SetupError(f"--clock and --landmarks need ROS 2; leave --middleware {NO_MIDDLEWARE} out")
        stack.enter_context(boards)
        _say(f"a rover drives as the bridge at {boards.remote} says; its boards listen on UDP port {boards.port}")
        pace = Pace(arguments.speed, _say)
        simulation = RoverSimulation(rover, datagrams, boards, pace, publish)
        with contextlib.suppress(KeyboardInterrupt):
            simulation.run(scenarios, arguments.seconds, restarts)
    _report(rover, simulation, as_json=arguments.json)
    return OK


def _say(message: str) -> None:
    print(message, file=sys.stderr, flush=True)


def _report(rover: RoverModel, simulation: RoverSimulation, *, as_json: bool) -> None:
    pose, seconds = rover.pose, rover.now / 1e9
    if as_json:
        place = {"x": pose.x, "y": pose.y, "yaw": pose.yaw}
        sent = dict(sorted(simulation.sent.items()))
        entry = {"seconds": seconds, "sent": sent, "unsendable": simulation.unsendable}
        print(json.dumps({**entry, "pose": place, "rolled": rover.rolled}))
        return
    sent_text = ", ".join(f"{count} {name}" for name, count in sorted(simulation.sent.items()))
    print(f"simulated {seconds:.1f} s; sent {sent_text or 'nothing'}; {simulation.unsendable} could not be sent")
    print(
        f"the wheels rolled {rover.rolled:.2f} m; the rover is at x {pose.x:.2f} m, y {pose.y:.2f} m, yaw "
        f"{math.degrees(pose.yaw):.1f} deg"
    )


class Boards(Protocol):
    """Boards of the rover as the bridge sees them."""

    def arrived(self) -> Sequence[Received]:
        """Return the payloads that have arrived."""

    def send_datagram(self, datagram: bytes) -> None:
        """Send a serialized envelope to the bridge."""


class RoverBoards:
    """Boards of a rover: they take what the bridge sends, and measure in each step of the rover's time."""

    def __init__(self, rover: RoverModel, datagrams: RoverDatagrams) -> None:
        self._rover, self._datagrams = rover, datagrams

    def receive(self, received: Received) -> None:
        """Let the driving board take a command; one that is no number is ignored, as by a real board."""
        command = self._datagrams.command(received.number, received.payload)
        if command is not None:
            with contextlib.suppress(ValueError):
                self._rover.command(command)

    def step(self) -> Stream:
        """Advance the time by a step, and yield what the boards send meanwhile."""
        for measured in self._rover.advance(STEP_NS / 1e9):
            name, datagram = self._datagrams.datagram(measured)
            yield Emission(measured.at / 1e9, self._datagrams.peer, name, datagram)


class RoverSimulation:
    """Rover whose boards exchange datagrams with a bridge, as fast as ``pace`` lets its time go."""

    def __init__(
        self,
        rover: RoverModel,
        datagrams: RoverDatagrams,
        boards: Boards,
        pace: Pace,
        publish: Callable[[RoverModel], None] | None = None,
    ) -> None:
        """Prepare; ``publish``, if given, is called after each step of the rover's time."""
        self._rover, self._rover_boards, self._boards = rover, RoverBoards(rover, datagrams), boards
        self._pace, self._publish = pace, publish
        self.sent = Counter[str]()
        """Number of sent datagrams by the name of the row."""
        self.unsendable = 0
        """Number of datagrams that the network of this computer refused."""

    def run(self, scenarios: Sequence[Scenario], seconds: float, restarts: random.Random | None = None) -> None:
        """Simulate some seconds of the rover's time.

        The scenarios change the datagrams one after the other. With ``restarts``, the driving board restarts now and
        then, at random times.
        """
        stream: Stream = self._measure(seconds, restarts)
        for change in scenarios:
            stream = change(stream)
        for emission in stream:
            try:
                self._boards.send_datagram(emission.datagram)
            except OSError:
                self.unsendable += 1
            else:
                self.sent[emission.name] += 1

    def _measure(self, seconds: float, restarts: random.Random | None) -> Stream:
        rover, next_restart = self._rover, _next_restart(0, restarts)
        while rover.now < seconds * 1e9:
            self._pace.wait(rover.now)
            for received in self._boards.arrived():
                self._rover_boards.receive(received)
            if rover.now >= next_restart:
                rover.restart_board()
                next_restart = _next_restart(rover.now, restarts)
            yield from self._rover_boards.step()
            if self._publish is not None:
                self._publish(rover)


def _next_restart(now: int, restarts: random.Random | None) -> float:
    """Return the time in nanoseconds at which the driving board restarts next."""
    return math.inf if restarts is None else now + restarts.uniform(*_BETWEEN_RESTARTS_S) * 1e9


class _Publications:
    """Topics of the simulated rover."""

    def __init__(self, middleware: Middleware, arguments: argparse.Namespace) -> None:
        """Create the publishers. Raises `SetupError` if the landmarks cannot be rendered."""
        # The stamps are near those of the bridge, whose time is that of the computer.
        self._began = time.time_ns()
        self._truth = TRUTH.publisher(middleware, topic_types.full_topic)
        self._clock: Publisher | None = None
        if arguments.clock:
            self._clock = CLOCK.publisher(middleware, topic_types.full_topic)
        self._camera: RoverCamera | None = None
        if arguments.landmarks is not None:
            from roverkit.simulation.rover_camera import RoverCamera

            self._camera = RoverCamera(arguments.landmarks, arguments.seed)
            self._images = IMAGE.publisher(middleware, topic_types.full_topic)
            self._infos = CAMERA_INFO.publisher(middleware, topic_types.full_topic)

    def publish(self, rover: RoverModel) -> None:
        """Publish what is due at the time of the rover."""
        stamp = self._began + rover.now
        if self._clock is not None:
            self._clock.publish([cdr.encode(rosgraph_msgs.Clock(Time.since_1970(stamp)))])
        if rover.now % _TRUTH_NS == 0:
            truth = OdometryEstimate(stamp, rover.pose, _ZEROS, rover.velocity, rover.yaw_rate, 0.0, 0.0)
            self._truth.publish([cdr.encode(odometry_of(truth, header_of(stamp, _MAP), _BASE))])
        if self._camera is not None and rover.now % _IMAGE_NS == 0 and self._images.has_subscribers():
            image, info = self._camera.messages(rover.pose, stamp)
            self._infos.publish([cdr.encode(info)])
            self._images.publish([cdr.encode(image)])


def _scenarios(names: Sequence[str], seed: int, registry: Registry) -> list[Scenario]:
    """Return scenarios as functions that change a stream of datagrams; `REBOOT` is not one of them."""
    generator = random.Random(seed)  # noqa: S311  # repeatable, not secret
    world = World(registry, generator, parameters.defaults(registry)["max_datagram"])

    def changing(scenario: Callable[[Stream, World], Stream]) -> Scenario:
        return lambda stream: scenario(stream, world)

    return [changing(SCENARIOS[name]) for name in names if name != REBOOT]
