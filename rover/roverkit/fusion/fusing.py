"""Implementation of ``roverlink fuse``: the rover's pose on the field, from odometry, landmarks and GPS.

The landmarks are received one by one, and not as the pose that the tracker computes from them: a pose does not say from
which landmarks it comes, and one of them may have been moved.
"""

from __future__ import annotations

import roverkit.vision  # noqa: F401  # first: it explains how to install numpy and OpenCV

# isort: split

import argparse
import logging
import math
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from roverkit.driving.geodesy import Datum
from roverkit.fusion.field_graph import CAUSES, FieldGraph
from roverkit.fusion.fusion_declaration import DETECTIONS, FIX, FUSED, ODOMETRY, TRANSFORM
from roverkit.fusion.gtsam_library import is_unsolvable
from roverkit.fusion.odometry_track import KEPT_NS, PLANAR, OdometryPoint, OdometryTrack, UnknownCovariance, point_of
from roverkit.fusion.planar_gaussian import Floats, PlanarGaussian, is_covariance
from roverkit.fusion.planar_landmarks import planar_detections, surveyed_places
from roverkit.gating import Reasons
from roverkit.node.program import connected, json_printer
from roverkit.node.reason_diagnostics import ReasonDiagnostics
from roverkit.node.ros_connection import RosConnection
from roverkit.odometry.odometry_messages import UNKNOWN_VARIANCE, pose_of
from roverkit.vision.camera.cameras_file import read_cameras
from roverkit.vision.localization.landmarks import Landmarks, read_landmarks
from roverkit.vision.markers.marker_set import TargetId
from roverkit.vision.poses.pose import Pose
from roverkit.vision.poses.transform_tree import TransformError
from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import ConversionError
from roverlink.runtime.interfaces import geometry_msgs, sensor_msgs, tf2_msgs, vision_msgs
from roverlink.runtime.interfaces.nav_msgs import Odometry
from roverlink.runtime.interfaces.std_msgs import Header
from roverlink.runtime.ros_arguments.ros_args import RosArguments
from roverlink.runtime.ros_time.headers import stamp_of

_WAITING = 100
"""Images that wait for odometry of their time."""
_SKEW_NS = 1_000_000_000
"""Age in nanoseconds that no message has if the clock of its computer is right."""
_LATEST_NS = KEPT_NS // 2
"""Age in nanoseconds of odometry from which no older input is expected."""
_PERIOD_NS = 1_000_000_000
"""Time in nanoseconds between two looks at what is missing."""
_RESULT = "pose"


def fuse(arguments: argparse.Namespace, ros: RosArguments, logger: logging.Logger) -> None:
    """Fuse until the program is stopped. Raises `SetupError` if a file or a package is missing or wrong."""
    landmarks = read_landmarks(arguments.landmarks)
    cameras = read_cameras(arguments.cameras) if arguments.cameras else []
    with connected(ros, arguments.middleware, logger) as connection:
        fusion = Fusion(connection, landmarks, arguments, logger)
        if not cameras:
            fusion.receive(DETECTIONS.name, None)
        for camera in cameras:
            fusion.receive(f"{camera.name}/{DETECTIONS.name}", camera.mount)
        logger.info("waiting for %s and for landmarks of %s", ros.topic(ODOMETRY.name), arguments.landmarks)
        while True:
            now = connection.clock.now()
            connection.clock.sleep_until(now + _PERIOD_NS, now)
            fusion.tick()


class Fusion:
    """Node that fuses; its topics are received on threads of the middleware."""

    def __init__(
        self, connection: RosConnection, landmarks: Landmarks, arguments: argparse.Namespace, logger: logging.Logger
    ) -> None:
        self._connection, self._landmarks, self._logger = connection, landmarks, logger
        self._base, self._datum, self._print = arguments.base_frame, arguments.datum, json_printer(arguments.json)
        self._mean_slip = arguments.mean_slip
        self._clock = connection.clock
        self._lock = threading.Lock()
        self.reasons = Reasons(logger.warning)
        """Reasons why inputs are left out, and why there is no pose."""
        self._diagnostics = ReasonDiagnostics(connection, self.reasons)
        self._odometry_at: int | None = None
        self._start()
        middleware, topic = connection.middleware, connection.topic
        self._fused = FUSED.publisher(middleware, topic)
        self._transforms = TRANSFORM.publisher(middleware, topic)
        ODOMETRY.subscribe(middleware, topic, self._take_odometry)
        if self._datum is not None:
            FIX.subscribe(middleware, topic, self._take_fixes)

    def receive(self, name: str, mount: Pose | None) -> None:
        """Receive the landmarks that a camera sees.

        ``mount`` is the transform from its frame to the rover's; None if it is on /tf.
        """
        if mount is None:
            _ = self._connection.transforms  # from now on, so that the static ones are there before the images
        take = partial(self._take_detections, mount=mount)
        replace(DETECTIONS, name=name).subscribe(self._connection.middleware, self._connection.topic, take)

    def _start(self) -> None:
        self._track = OdometryTrack(self._mean_slip)
        self._forget_pose()
        self._covariance: list[float] = []
        self._without_covariance: UnknownCovariance | None = None
        self._waiting: list[tuple[int, Callable[[OdometryPoint], None]]] = []

    def _forget_pose(self) -> None:
        self._graph = FieldGraph(surveyed_places(self._landmarks), self.reasons)
        self._moved: Mapping[TargetId, float] = {}

    @contextmanager
    def _solving(self) -> Iterator[None]:
        """Begin again without a pose if the graph cannot be solved."""
        try:
            yield
        except RuntimeError as error:
            if not is_unsolvable(error):
                raise
            self.reasons.tell("no pose follows from the inputs, which contradict each other; beginning again")
            self._forget_pose()

    def tick(self) -> None:
        """Look whether odometry comes, without which there is no pose, and publish the reasons."""
        with self._lock:
            now = self._clock.now()
            if self._odometry_at is None or now - self._odometry_at > _PERIOD_NS:
                self.reasons.lack(_RESULT, f"no odometry comes on {self._connection.topic(ODOMETRY.name)}", now)
            self._diagnostics.publish(now)

    # --- inputs ---

    def _take_odometry(self, messages: Sequence[bytes]) -> None:
        with self._lock:
            for data in messages:
                try:
                    message = cdr.decode(Odometry, data)
                    point = self._point_of(message)
                except ConversionError as error:
                    self.reasons.tell(f"odometry left out: {error}")
                    continue
                self._odometry_at = self._clock.now()
                before = self._track.newest
                if not self._track.add(point):
                    self.reasons.tell(f"the time or the pose of {ODOMETRY.name} has jumped; beginning again")
                    self._start()
                    self._track.add(point)
                self._catch_up(point.stamp)
                with self._solving():
                    if (past := self._track.at(point.stamp - _LATEST_NS)) is not None:
                        self._graph.follow(past)
                    if (newest := self._track.newest) is not None and newest is not before:
                        self._publish(newest, message)

    def _take_detections(self, messages: Sequence[bytes], mount: Pose | None) -> None:
        with self._lock:
            for data in messages:
                try:
                    message = cdr.decode(vision_msgs.Detection3DArray, data)
                    stamp, camera = stamp_of(message.header), message.header.frame_id
                    place = mount or self._connection.transforms.look_up(self._base, camera, stamp)
                    detections = planar_detections(message, place, self._landmarks, self.reasons.tell)
                except (ConversionError, TransformError) as error:
                    # The age in the text changes with every image.
                    reason, _, details = str(error).partition(":")
                    self.reasons.tell(f"landmarks left out: {reason}", details.strip())
                    continue
                if self._is_ahead("landmarks", stamp):
                    continue
                self._wait(stamp, partial(self._see, detections))

    def _take_fixes(self, messages: Sequence[bytes]) -> None:
        with self._lock:
            for data in messages:
                try:
                    fix = cdr.decode(sensor_msgs.NavSatFix, data)
                    if fix.status.status < sensor_msgs.NavSatStatus.STATUS_FIX:
                        continue
                    position, covariance = _on_field(fix, *self._datum)
                except ConversionError as error:
                    self.reasons.tell(f"GPS position left out: {error}")
                    continue
                if not self._is_ahead("GPS positions", stamp := stamp_of(fix.header)):
                    self._wait(stamp, partial(self._locate, position, covariance))

    def _is_ahead(self, what: str, stamp: int) -> bool:
        """Return true, and count it, if a stamp is ahead of the own clock. Say so if it is long ago."""
        age = self._clock.now() - stamp
        if age > _SKEW_NS:
            self.reasons.note(f"{what} come late; is the clock of their computer right?", f"{age / 1e9:.1f} s")
        if age < -_SKEW_NS:
            self.reasons.tell(
                f"{what} left out: the stamp is in the future; is the clock of their computer right?",
                f"{-age / 1e9:.1f} s ahead",
            )
        return age < -_SKEW_NS

    def _point_of(self, message: Odometry) -> OdometryPoint:
        """Return the odometry of a message; see `point_of`.

        A covariance of zeros is unknown by ROS 2's convention. One that does not grow on the way is a constant of its
        program, and says nothing about the motion.
        """
        point = point_of(message)
        before, self._covariance = self._covariance, list(message.pose.covariance)
        newest = self._track.newest or point
        stands = newest.pose == point.pose and self._without_covariance is None
        if any(self._covariance) and (self._covariance != before or stands):
            self._without_covariance = None
            return point
        self.reasons.note(
            "odometry without covariance, or with one that never grows",
            "that of wheel odometry without an IMU is taken",
        )
        if self._without_covariance is None:
            self._without_covariance = UnknownCovariance(newest.pose)
        return replace(point, covariance=self._without_covariance.at(point.pose))

    def _wait(self, stamp: int, use: Callable[[OdometryPoint], None]) -> None:
        """Use a measurement with the odometry of its time, which comes later if its message takes longer."""
        self._waiting.append((stamp, use))
        self._waiting.sort(key=lambda waiting: waiting[0])
        del self._waiting[:-_WAITING]
        if (newest := self._track.newest) is not None:
            self._catch_up(newest.stamp)

    def _see(self, detections: Mapping[TargetId, PlanarGaussian], point: OdometryPoint) -> None:
        self._graph.see(detections, point)
        if self._graph.is_lost:
            self.reasons.tell(f"no landmark fits any more: {CAUSES}; beginning again")
            self._graph, self._moved = self._graph.begun_again(point), {}

    def _locate(self, position: Floats, covariance: Floats, point: OdometryPoint) -> None:
        self._graph.locate(position, covariance, point)

    def _catch_up(self, now: int) -> None:
        """Use the measurements for whose times the odometry is known."""
        while self._waiting and self._waiting[0][0] <= now:
            stamp, use = self._waiting.pop(0)
            if (point := self._track.at(stamp)) is not None:
                with self._solving():
                    use(point)
        self._tell_moved()

    # --- outputs ---

    def _publish(self, point: OdometryPoint, odometry: Odometry) -> None:
        place = self._graph.pose(point)
        if place is None:
            self.reasons.lack(_RESULT, self._graph.unknown, self._clock.now())
            return
        self.reasons.give(_RESULT)
        header = Header(odometry.header.stamp, self._landmarks.frame)
        self._fused.publish([cdr.encode(Odometry(header, odometry.child_frame_id, _pose_of(place), odometry.twist))])
        shift = place.pose @ point.pose.inverse()
        transform = geometry_msgs.Transform(geometry_msgs.Vector3(shift.x, shift.y), pose_of(shift).orientation)
        stamped = geometry_msgs.TransformStamped(header, odometry.header.frame_id, transform)
        self._transforms.publish([cdr.encode(tf2_msgs.TFMessage([stamped]))])
        pose, spread = place.pose, place.outer_covariance
        entry = {"stamp": point.stamp, "x": pose.x, "y": pose.y, "yaw": math.remainder(pose.yaw, 2 * math.pi)}
        deviation = [math.sqrt(value) for value in spread.diagonal().tolist()]
        self._print({**entry, "deviation": deviation, "moved": [*self._moved]})

    def _tell_moved(self) -> None:
        """Name landmarks that stand elsewhere than the survey says, once when this is found."""
        moved = self._graph.moved
        for name in moved.keys() - self._moved.keys():
            self._logger.warning(
                "landmark %s is not used: it stands %.2f m beside its place in the file of landmarks, or was turned",
                name,
                moved[name],
            )
        for name in self._moved.keys() - moved.keys():
            self._logger.info("landmark %s is used again", name)
        self._moved = moved


def _on_field(fix: sensor_msgs.NavSatFix, latitude: float, longitude: float, heading: float) -> tuple[Any, Any]:
    """Return the position (2,) of a GPS receiver on the field, and its covariance (2, 2).

    The datum is the origin of the field; ``heading`` is the direction of the field's x axis in radians,
    counterclockwise from the east. Raises `ConversionError` for values that are no numbers, and without a covariance.
    """
    covariance = np.reshape(fix.position_covariance, (3, 3))[:2, :2]
    if not (abs(fix.latitude) <= 90 and math.isfinite(fix.longitude) and is_covariance(covariance)):
        raise ConversionError("it has no position or no covariance")
    cosine, sine = math.cos(heading), math.sin(heading)
    to_field = np.array([[cosine, sine], [-sine, cosine]])
    east_north = np.array(Datum(latitude, longitude).planar(fix.latitude, fix.longitude))
    return to_field @ east_north, to_field @ covariance @ to_field.T


def _pose_of(place: PlanarGaussian) -> geometry_msgs.PoseWithCovariance:
    covariance = np.diag([UNKNOWN_VARIANCE] * 6)
    covariance[PLANAR] = place.outer_covariance
    return geometry_msgs.PoseWithCovariance(pose_of(place.pose), covariance.ravel().tolist())
