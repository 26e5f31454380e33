"""Rover of the demo: the simulated one. It drives as the messages say that the demo publishes on ``drive_motor``."""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping, Sequence

from roverkit.demo.driven_path import DrivenPath
from roverkit.demo.shuttle import START, Shuttle
from roverkit.driving.arcs import PlanarPose
from roverkit.driving.board_commands import STOP
from roverkit.driving.drive_declaration import COMMAND
from roverkit.node.ros_connection import RosConnection
from roverkit.odometry.odometry_declaration import DIAGNOSTICS, ODOMETRY, PROGRESS
from roverkit.odometry.odometry_parameters import OdometryParameters
from roverkit.odometry.odometry_rows import OdometryRows
from roverkit.odometry.wheel_odometry_node import OdometryNode
from roverkit.simulation.rover_datagrams import GPS, IMU, RoverDatagrams
from roverkit.simulation.rover_model import RoverModel
from roverkit.simulation.simulated_rover import RoverBoards
from roverlink import topic_types
from roverlink.runtime import Registry
from roverlink.runtime.client import BlockingPeer, Received
from roverlink.runtime.core import cdr
from roverlink.runtime.interfaces.nav_msgs import Odometry
from roverlink.runtime.middleware import Middleware
from roverlink.runtime.ros_arguments.ros_args import RosArguments
from roverlink.simulation.demo_parts import DemoPart

_SEED = 1
_COMMAND_NS = 100_000_000
"""Time between two commands in nanoseconds: the driving board reports twice as often, so odometry needs no guess."""
_STANDING_NS = 1_000_000_000
"""Time in nanoseconds for which the rover stands at first, so that the odometry learns the bias of the gyroscope."""


class DemoRover(DemoPart):
    """Rover with its driver and its wheel odometry, which are ROS 2 nodes on the other side of the bridge."""

    rows = (COMMAND.row, PROGRESS.row, DIAGNOSTICS.row, IMU, GPS)

    def __init__(self, registry: Registry) -> None:
        """Place the rover at its start. Raises `SetupError` if the table lacks one of the rows."""
        datagrams = RoverDatagrams(registry)
        self._rows = OdometryRows(registry)
        self._command = registry.by_name[COMMAND.row]
        self._model = RoverModel(_SEED, start=START)
        self._boards = RoverBoards(self._model, datagrams)
        self._driver = Shuttle()
        self._publish: Callable[[Sequence[bytes]], object] = lambda _: None
        self._odometry_since: int | None = None
        self._peer = datagrams.peer
        self.driven = DrivenPath()

    @property
    def pose(self) -> PlanarPose:
        """True pose of base_link in the map."""
        return self._model.pose

    def join(self, middleware: Middleware) -> None:
        """Create the publisher of the driver, and the node that computes the wheel odometry."""
        self._publish = self._rows.command.publisher(middleware, topic_types.full_topic).publish
        ros, logger = RosArguments(topic_types.identity("odometry")), logging.getLogger("odometry")
        connection = RosConnection.over(middleware, ros, logger.warning)
        OdometryNode(connection, self._rows, OdometryParameters(ros, logger), logger, as_json=False).receive()
        ODOMETRY.subscribe(middleware, ros.topic, self._take_odometry)

    def receive(self, peer: str, received: Received) -> None:
        """Take a payload that the bridge has sent to the boards; those for other peers are ignored."""
        if peer == self._peer:
            self._boards.receive(received)

    def step(self, peers: Mapping[str, BlockingPeer]) -> None:
        """Advance the rover's time by a step: send what its boards measure, and now and then publish a command."""
        for emission in self._boards.step():
            peers[self._peer].send_datagram(emission.datagram)
        if self._model.now % _COMMAND_NS == 0:
            self._drive()

    def _drive(self) -> None:
        since, row = self._odometry_since, self._command
        stands = since is None or self._model.now - since < _STANDING_NS
        command = STOP if stands else self._driver.command(self.pose)
        payload = row.payload_type(distance_to_go=command.distance_to_go, turning_radius=command.turning_radius)
        self._publish([row.to_cdr(payload)])

    def stop(self) -> str:
        """Return a text for the user about the way of the rover, and the error of its odometry."""
        text = f"the rover drove {self._model.rolled:.1f} m as the messages on drive_motor said"
        error = self.driven.odometry.error
        return text if error is None else f"{text}; its wheel odometry is {1e3 * error:.0f} mm beside the truth"

    def _take_odometry(self, messages: Sequence[bytes]) -> None:
        if self._odometry_since is None:
            self._odometry_since = self._model.now
        for data in messages:
            position = cdr.decode(Odometry, data).pose.pose.position
            # The frame odom is that of the rover at the start.
            estimated, pose = START @ PlanarPose(position.x, position.y), self.pose
            self.driven.true.append((pose.x, pose.y))
            self.driven.odometry.add((estimated.x, estimated.y), (pose.x, pose.y))
