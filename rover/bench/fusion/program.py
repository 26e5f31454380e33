"""``roverlink fuse`` itself, in this process: its node gets the messages of a drive, and its poses are recorded."""

from __future__ import annotations

import argparse
import logging
import math
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from types import SimpleNamespace

import numpy as np
from roverkit.fusion.fusing import Fusion
from roverkit.fusion.fusion_declaration import DETECTIONS, FIX, FUSED, ODOMETRY
from roverkit.node.ros_connection import RosConnection
from roverkit.odometry.dead_reckoning import OdometryNoise
from roverkit.vision import Landmark, Landmarks, Pose, TargetId

from rover.bench.fusion.drives import Drive, Fix, Floats, Noise, apart, range_bearing
from rover.bench.fusion.filters import START, Estimate, GatedFilter
from roverlink.runtime.convert.rotations import angles, quaternion
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Qos
from roverlink.runtime.core.messages import Message
from roverlink.runtime.interfaces import geometry_msgs, nav_msgs, sensor_msgs, std_msgs, vision_msgs
from roverlink.runtime.middleware.memory import MemoryMiddleware
from roverlink.runtime.ros_arguments import ros_args
from roverlink.runtime.ros_time.headers import header_of, stamp_of

PLANAR = np.ix_([0, 1, 5], [0, 1, 5])
_SURVEYED_M, _UPRIGHT_RAD, _UNKNOWN_RAD = 0.005, 0.01, 30.0
"""Standard deviations of the place of a landmark, of its direction, and of a direction that nobody has measured."""
_BEGIN_S = 1.0
"""Stamp of the start; a stamp of 0 is none."""


class Program:
    """Node of ``roverlink fuse`` in a graph of its own."""

    def __init__(self, stack: ExitStack, landmarks: Landmarks, datum: tuple[float, float] | None) -> None:
        """Start it; the x axis of the field points to the east."""
        self.said: list[str] = []
        self.found: dict[int, Estimate] = {}
        logger = logging.Logger("fusion")
        logger.addHandler(handler := logging.Handler())
        handler.emit = lambda record: self.said.append(record.getMessage())  # type: ignore[method-assign]
        connection = RosConnection(ros_args.parse([], "fusion"), "memory", stack, logger.warning)
        connection.middleware = self._middleware = MemoryMiddleware()
        self._now = 0
        connection.clock = SimpleNamespace(now=lambda: self._now)  # the time of the drive
        arguments = argparse.Namespace(
            base_frame="base_link",
            json=False,
            mean_slip=OdometryNoise().mean_slip,
            datum=[*datum, 0.0] if datum else None,
        )
        fusion = Fusion(connection, landmarks, arguments, logger)
        fusion.receive(DETECTIONS.name, Pose(np.eye(3), np.zeros(3)))
        self._publishers = {
            name: self._middleware.publisher(f"/{name}", kind, Qos())
            for name, kind in (
                (ODOMETRY.name, nav_msgs.Odometry),
                (DETECTIONS.name, vision_msgs.Detection3DArray),
                (FIX.name, sensor_msgs.NavSatFix),
            )
        }
        self._middleware.subscribe(f"/{FUSED.name}", nav_msgs.Odometry, Qos(), self._take)

    def publish(self, name: str, message: Message, now: int) -> None:
        """Publish a message at a time in nanoseconds."""
        self._now = now
        self._publishers[name].publish([cdr.encode(message)])

    def _take(self, messages: Sequence[bytes]) -> None:
        for data in messages:
            message = cdr.decode(nav_msgs.Odometry, data)
            place, covariance = message.pose.pose, np.reshape(message.pose.covariance, (6, 6))[PLANAR]
            pose = np.array([place.position.x, place.position.y, angles(place.orientation)[2]])
            self.found[stamp_of(message.header)] = pose, covariance


def fused(drive: Drive, noise: Noise) -> tuple[dict[float, Estimate], list[str]]:
    """Return what ``roverlink fuse`` makes of a drive, by the time, and what it says."""
    start = drive.true_pose(drive.start)
    places: Mapping[int, Floats] = drive.landmarks or {0: start[:2]}
    landmarks: dict[TargetId, Landmark] = {
        name: Landmark(Pose(np.eye(3), np.array([*place, 0.0])), _SURVEYED_M, _UPRIGHT_RAD)
        for name, place in places.items()
    }
    inputs = sorted([(time, 0) for time in drive.sightings] + [(time, 1) for time in drive.fixes])
    inputs = [one for one in inputs if one[0] > drive.start]
    dead = GatedFilter(np.zeros(3), noise)
    dead.covariance = np.zeros((3, 3))
    last, times = drive.start, {}
    with ExitStack() as stack:
        program = Program(stack, Landmarks("map", landmarks), drive.datum)
        nearest = min(places, key=lambda one: range_bearing(start, places[one])[0])
        program.publish(
            DETECTIONS.name, _first(nearest, apart(start, np.array([*places[nearest], 0.0]))), _stamp(drive, last)
        )
        for now in drive.times:
            while inputs and inputs[0][0] <= now:
                time, kind = inputs.pop(0)
                stamp = _stamp(drive, time)
                if kind:
                    program.publish(FIX.name, _fix(drive.fixes[time], stamp), stamp)
                else:
                    program.publish(DETECTIONS.name, _sightings(drive.sightings[time], noise, stamp), stamp)
            motion = drive.motion(last, now)
            dead.move(*motion)
            speed = float(motion[0]) / (now - last) if now > last else 0.0
            last = now
            times[stamp := _stamp(drive, now)] = now
            program.publish(ODOMETRY.name, _odometry(dead, speed, stamp), stamp)
        return {times[stamp]: estimate for stamp, estimate in program.found.items()}, program.said


def _stamp(drive: Drive, time: float) -> int:
    return round((time - drive.start + _BEGIN_S) * 1e9)


def _first(name: int, place: Floats) -> vision_msgs.Detection3DArray:
    """Return the sighting of a landmark that tells the first pose: all contestants know it by `START`."""
    return vision_msgs.Detection3DArray(header_of(round(_BEGIN_S * 1e9), "base_link"), [_detection(name, place, START)])


def _sightings(seen: Mapping[int, tuple[float, float]], noise: Noise, stamp: int) -> vision_msgs.Detection3DArray:
    detections = []
    by_ahead, by_left, offset = noise.depth
    for name, (depth, bearing) in seen.items():
        bearing -= noise.bearing_offset
        way = np.array([math.cos(bearing), math.sin(bearing)])
        aside = np.array([-way[1], way[0]])
        along = way @ (by_ahead, by_left)
        distance = (depth - offset) / along
        by_depth, by_bearing = way / along, distance * (aside - way * (aside @ (by_ahead, by_left)) / along)
        derivative = np.zeros((3, 3))
        derivative[:2] = np.column_stack([by_depth, by_bearing, np.zeros(2)])
        derivative[2, 2] = 1.0
        own = np.diag([distance * noise.depth_deviation, noise.bearing_deviation, _UNKNOWN_RAD]) ** 2
        place = np.array([*distance * way, 0.0])
        detections.append(_detection(name, place, derivative @ own @ derivative.T))
    return vision_msgs.Detection3DArray(header_of(stamp, "base_link"), detections)


def _detection(name: int, place: Floats, covariance: Floats) -> vision_msgs.Detection3D:
    whole = np.diag([1e-4] * 6)
    whole[PLANAR] = covariance
    x, y, yaw = place.tolist()
    pose = geometry_msgs.Pose(geometry_msgs.Point(x, y), geometry_msgs.Quaternion(*quaternion(0.0, 0.0, yaw)))
    hypothesis = vision_msgs.ObjectHypothesisWithPose(
        vision_msgs.ObjectHypothesis(str(name), 1.0), geometry_msgs.PoseWithCovariance(pose, whole.ravel().tolist())
    )
    return vision_msgs.Detection3D(results=[hypothesis], id=str(name))


def _odometry(dead: GatedFilter, speed: float, stamp: int) -> nav_msgs.Odometry:
    """Return the message of a driver that knows no covariance of the velocities, as many do."""
    whole = np.diag([1e6] * 6)
    whole[PLANAR] = dead.covariance
    x, y, yaw = dead.pose.tolist()
    pose = geometry_msgs.Pose(geometry_msgs.Point(x, y), geometry_msgs.Quaternion(*quaternion(0.0, 0.0, yaw)))
    header: std_msgs.Header = header_of(stamp, "odom")
    return nav_msgs.Odometry(
        header,
        "base_link",
        geometry_msgs.PoseWithCovariance(pose, whole.ravel().tolist()),
        geometry_msgs.TwistWithCovariance(geometry_msgs.Twist(geometry_msgs.Vector3(speed))),
    )


def _fix(fix: Fix, stamp: int) -> sensor_msgs.NavSatFix:
    whole = np.diag([1e4] * 3)
    whole[:2, :2] = fix.covariance
    return sensor_msgs.NavSatFix(
        header_of(stamp, "gps"),
        sensor_msgs.NavSatStatus(sensor_msgs.NavSatStatus.STATUS_FIX, sensor_msgs.NavSatStatus.SERVICE_GPS),
        fix.latitude,
        fix.longitude,
        0.0,
        whole.ravel().tolist(),
        sensor_msgs.NavSatFix.COVARIANCE_TYPE_KNOWN,
    )
