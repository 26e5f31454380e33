"""Drive of the simulated rover on a field with landmarks, with `Fusion` as another node in this process.

The rover follows a square by its true pose, as a person would steer it.
"""

from __future__ import annotations

import argparse
import logging
import math
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from types import SimpleNamespace
from typing import Any

import numpy as np
from roverkit.driving.arcs import Arc, PlanarPose, arc_to
from roverkit.fusion.fusing import Fusion
from roverkit.fusion.fusion_declaration import DETECTIONS, FIX, FUSED, ODOMETRY
from roverkit.fusion.planar_gaussian import PlanarGaussian, rotation
from roverkit.gating import Reasons
from roverkit.node.ros_connection import RosConnection
from roverkit.odometry.dead_reckoning import OdometryNoise
from roverkit.odometry.odometry_messages import odometry_of
from roverkit.odometry.wheel_odometry import OdometryEstimate, WheelOdometry
from roverkit.simulation.rover_model import Measurement, MotorReport, ProgressReport, RoverModel, RoverSettings
from roverkit.simulation.rover_sensors import GpsFix, ImuReading
from roverkit.vision import TargetId

from rover.tests.driving.simulated_tracker import SimulatedTracker, field, standing
from roverlink.runtime.convert.rotations import angles
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Qos
from roverlink.runtime.core.messages import Message
from roverlink.runtime.interfaces import geometry_msgs, sensor_msgs, tf2_msgs, vision_msgs
from roverlink.runtime.interfaces.nav_msgs import Odometry
from roverlink.runtime.middleware import Publisher
from roverlink.runtime.middleware.memory import MemoryMiddleware
from roverlink.runtime.ros_arguments import ros_args
from roverlink.runtime.ros_time.headers import header_of, stamp_of

_CORNERS = ((1.5, 1.5), (-1.5, 1.5), (-1.5, -1.5), (1.5, -1.5))
_NEAR_M = 0.7
_STEP_S = 0.1
_COMMAND_STEPS = 5
_IMAGE_STEPS = 2
_PLANAR = np.ix_([0, 1, 5], [0, 1, 5])


class FieldDrive:
    """Simulated rover with its odometry and its tracker, and what the fusion makes of them."""

    def __init__(
        self,
        seed: int,
        stack: ExitStack,
        moved: Mapping[TargetId, tuple[float, float]] = {},  # never changed
        *,
        gps: bool = False,
        sees: bool = True,
        odometry: bool = True,
        change: Callable[[Any, float], None] = lambda _, __: None,
        sense: Callable[[Measurement], Measurement | None] = lambda one: one,
        settings: RoverSettings | None = None,
        logger: logging.Logger | None = None,
    ) -> None:
        self._has_odometry = odometry
        self._change, self._sense = change, sense  # of a message, at a time in seconds; of a measurement
        self.start = PlanarPose(1.5, -1.0, math.pi / 2)
        self.model = RoverModel(seed, settings, self.start)
        self.said: list[str] = []
        """Messages of the odometry."""
        self._odometry = WheelOdometry(reasons=Reasons(self.said.append))
        landmarks = field()
        self._tracker = SimulatedTracker(seed, standing(landmarks, seed, moved))
        self._corner = self._steps = 0
        self.sees = sees  # False while somebody stands before the camera
        self.stamp = 10**9  # at which the model starts
        self.middleware = middleware = MemoryMiddleware()
        self._wheel = middleware.publisher(f"/{ODOMETRY.name}", Odometry, Qos())
        self._detections = middleware.publisher(f"/{DETECTIONS.name}", vision_msgs.Detection3DArray, Qos())
        self._fixes = middleware.publisher(f"/{FIX.name}", sensor_msgs.NavSatFix, Qos())
        datum = self.model.settings.gps.datum
        arguments = argparse.Namespace(
            base_frame="base_link",
            json=False,
            mean_slip=OdometryNoise().mean_slip,
            datum=[datum.latitude, datum.longitude, 0.0] if gps else None,
        )
        said = logger or logging.getLogger("fusion of a test")
        connection = RosConnection(ros_args.parse([], "fusion"), "memory", stack, said.warning)
        connection.middleware = middleware  # so that both nodes are in one graph
        connection.clock = SimpleNamespace(now=lambda: self.stamp + self.model.now)  # type: ignore[assignment]  # the time of the model
        self._fusion = Fusion(connection, landmarks, arguments, said)
        self._fusion.receive(DETECTIONS.name, self._tracker.mount)
        self.reasons = self._fusion.reasons
        self.fused: list[Odometry] = []
        self.shifts: list[geometry_msgs.TransformStamped] = []
        middleware.subscribe(f"/{FUSED.name}", Odometry, Qos(), self._take)
        middleware.subscribe("/tf", tf2_msgs.TFMessage, Qos(), self._take_transforms)
        self.by_odometry: PlanarGaussian | None = None

    def move_landmark(self, name: TargetId, x: float, y: float) -> None:
        """Let somebody move a landmark by some metres on the field."""
        self._tracker.move(name, x, y)

    def stand(self, seconds: float) -> None:
        """Let the rover stand."""
        for _ in range(round(seconds / _STEP_S)):
            self._step()

    def drive(self, metres: float, watch: Callable[[], None] = lambda: None) -> None:
        """Drive along the square for a distance; ``watch`` is called ten times a second."""
        until = self.model.rolled + metres
        while self.model.rolled < until:
            if self._steps % _COMMAND_STEPS == 0:
                self._steer()
            self._step()
            watch()

    @property
    def error(self) -> tuple[np.ndarray, np.ndarray]:
        """Error (3,) of the newest fused pose in its axes, and its covariance (3, 3)."""
        message = self.fused[-1]
        place = message.pose.pose
        pose = PlanarPose(place.position.x, place.position.y, angles(place.orientation)[2])
        turned = rotation(pose.yaw)
        covariance = turned.T @ np.reshape(message.pose.covariance, (6, 6))[_PLANAR] @ turned
        apart = pose.inverse() @ self.model.pose
        return np.array([apart.x, apart.y, math.remainder(apart.yaw, 2 * math.pi)]), covariance

    @property
    def odometry_error(self) -> tuple[np.ndarray, np.ndarray]:
        """Error (3,) of the newest pose of the odometry alone in the frame odom, and its covariance (3, 3)."""
        assert self.by_odometry is not None
        pose, truth = self.by_odometry.pose, self.start.inverse() @ self.model.pose
        turned = math.remainder(truth.yaw - pose.yaw, 2 * math.pi)
        return np.array([truth.x - pose.x, truth.y - pose.y, turned]), self.by_odometry.covariance

    def _steer(self) -> None:
        x, y = _CORNERS[self._corner % len(_CORNERS)]
        ahead = self.model.pose.inverse() @ PlanarPose(x, y)
        if math.hypot(ahead.x, ahead.y) < _NEAR_M:
            self._corner += 1
            self._steer()
            return
        board = self.model.settings.board
        arc = board.drivable(arc_to(ahead.x, ahead.y) if ahead.x > 0.1 else Arc(2.0, math.copysign(1.5, ahead.y)))
        self.model.command(board.command(arc))
        self._odometry.command(self.model.now, arc)

    def _step(self) -> None:
        self._steps += 1
        self._fusion.tick()
        for one in filter(None, map(self._sense, self.model.advance(_STEP_S))):
            if isinstance(one, ImuReading):
                self._odometry.angular_velocity(one.at, one.angular_velocity[2])
            elif isinstance(one, MotorReport):
                self._odometry.motors(one.at, (abs(one.left_rpm) + abs(one.right_rpm)) / 2)
            elif isinstance(one, ProgressReport):
                estimate = self._odometry.progress(one.at, one.distance_left)
                if estimate is not None:
                    self._publish(estimate)
            elif isinstance(one, GpsFix):
                self._send(self._fixes, _fix(one, self.stamp))
        if self.sees and self._steps % _IMAGE_STEPS == 0:
            self._send(self._detections, self._tracker.see(self.model.pose, self.stamp + self.model.now))

    def _publish(self, estimate: OdometryEstimate) -> None:
        self.by_odometry = PlanarGaussian(estimate.pose, np.array(estimate.covariance))
        header = header_of(self.stamp + estimate.at, "odom")
        if self._has_odometry:
            self._send(self._wheel, odometry_of(estimate, header, "base_link"))

    def _send(self, publisher: Publisher, message: Message) -> None:
        self._change(message, self.model.now / 1e9)
        publisher.publish([cdr.encode(message)])

    def _take(self, messages: Sequence[bytes]) -> None:
        self.fused += [cdr.decode(Odometry, one) for one in messages]

    def _take_transforms(self, messages: Sequence[bytes]) -> None:
        for one in messages:
            self.shifts += cdr.decode(tf2_msgs.TFMessage, one).transforms

    @property
    def is_current(self) -> bool:
        """True if the newest fused pose is of now."""
        return bool(self.fused) and stamp_of(self.fused[-1].header) == self.stamp + self.model.now


def _fix(one: GpsFix, start: int) -> sensor_msgs.NavSatFix:
    variance = 0.6**2
    return sensor_msgs.NavSatFix(
        header_of(start + one.at, "gps_link"),
        sensor_msgs.NavSatStatus(sensor_msgs.NavSatStatus.STATUS_FIX, sensor_msgs.NavSatStatus.SERVICE_GPS),
        one.latitude,
        one.longitude,
        one.altitude,
        np.diag([variance, variance, 4 * variance]).ravel().tolist(),
        sensor_msgs.NavSatFix.COVARIANCE_TYPE_DIAGONAL_KNOWN,
    )
