# Generated from mapping.yaml (row weather) and board.proto; do not edit.
# Regenerate with: roverlink generate
"""weather (1): Weather to sensor_msgs/msg/Imu on /imu/data."""

from __future__ import annotations

import math

from generated.interfaces import geometry_msgs, sensor_msgs, std_msgs
from generated.pb2 import board_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.feed import UNSTAMPED, Feed, single
from roverlink.runtime.core.handler import Route
from roverlink.runtime.interfaces import Time

_RPM_TO_RAD_PER_S = math.pi / 30.0
_DEG_PER_S_TO_RAD_PER_S = math.pi / 180_000.0
_CDR = cdr.template(
    sensor_msgs.Imu(
        header=std_msgs.Header(frame_id="imu_link"),
        orientation_covariance=[-1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        angular_velocity=geometry_msgs.Vector3(y=1.5),
        linear_acceleration_covariance=[0.5, 0.0, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0, 0.5],
    ),
    ["header.stamp", "angular_velocity.x", "angular_velocity.z", "linear_acceleration"],
)
(
    _UP_TO_HEADER_STAMP_SEC,
    _UP_TO_ANGULAR_VELOCITY_X,
    _UP_TO_ANGULAR_VELOCITY_Z,
    _UP_TO_LINEAR_ACCELERATION_X,
    _REST,
) = _CDR.constants
_PACK = _CDR.layout.pack


class WeatherImuDataFeed(Feed[board_pb2.Weather, sensor_msgs.Imu]):
    """Weather to sensor_msgs/Imu on the topic /imu/data."""

    route = Route(number=1, name="weather", topic="/imu/data", direction="board_to_ros")
    payload_type = board_pb2.Weather
    message_type = sensor_msgs.Imu

    @staticmethod
    def to_ros(payload: board_pb2.Weather, stamp: Time = UNSTAMPED) -> sensor_msgs.Imu:
        """The message that says what the payload says."""
        return sensor_msgs.Imu(
            header=std_msgs.Header(stamp=stamp, frame_id="imu_link"),
            orientation_covariance=[-1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            angular_velocity=geometry_msgs.Vector3(
                x=payload.spin * _RPM_TO_RAD_PER_S,
                y=1.5,
                z=-payload.spin * _DEG_PER_S_TO_RAD_PER_S,
            ),
            linear_acceleration=geometry_msgs.Vector3(
                x=payload.acceleration.x * 0.00980665,
                y=payload.acceleration.y * 0.00980665,
                z=payload.acceleration.z * 0.00980665,
            ),
            linear_acceleration_covariance=[
                0.5,
                0.0,
                0.0,
                0.0,
                0.5,
                0.0,
                0.0,
                0.0,
                0.5,
            ],
        )

    @staticmethod
    def from_ros(message: sensor_msgs.Imu) -> board_pb2.Weather:
        """The payload that says what the message says.

        It says nothing of pressure_x10, fahrenheit, humidity, light.
        """
        return board_pb2.Weather(
            spin=round(message.angular_velocity.x / _RPM_TO_RAD_PER_S),
            acceleration={
                "x": single(message.linear_acceleration.x / 0.00980665),
                "y": single(message.linear_acceleration.y / 0.00980665),
                "z": single(message.linear_acceleration.z / 0.00980665),
            },
        )

    def pack(self, payload: board_pb2.Weather, stamp: Time = UNSTAMPED) -> bytes:
        """`to_ros` and its serialization in one step: what varies, in the order of the .msg."""
        return _PACK(
            _UP_TO_HEADER_STAMP_SEC,
            stamp.sec,
            stamp.nanosec,
            _UP_TO_ANGULAR_VELOCITY_X,
            payload.spin * _RPM_TO_RAD_PER_S,
            _UP_TO_ANGULAR_VELOCITY_Z,
            -payload.spin * _DEG_PER_S_TO_RAD_PER_S,
            _UP_TO_LINEAR_ACCELERATION_X,
            payload.acceleration.x * 0.00980665,
            payload.acceleration.y * 0.00980665,
            payload.acceleration.z * 0.00980665,
            _REST,
        )
