"""Load and observer on an installed ROS 2, with rclpy: the same lines as of load.cpp and observe.cpp.

python -m bench.rclpy_tools load
observe
"""

import struct
import sys
import time
from collections.abc import Sequence

from bench.load import Send, answer
from bench.observe import STAMP_IN_IMU
from bench.observe import answer as answer_ages
from bench.stamp import age_ns, stamp
from generated.messages import DrivingBoardMotorMessage, ImuSensorInformation
from roverlink.runtime import Qos
from roverlink.runtime.middleware import Middleware, NodeIdentity, open_middleware

MOTOR = struct.Struct("<4s2f")  # CDR header, distance_to_go, turning_radius


def samples(middleware: Middleware) -> Send:
    """Return a function that publishes a message with the current time on /drive_motor."""
    publisher = middleware.publisher("/drive_motor", DrivingBoardMotorMessage, Qos())

    def send() -> None:
        publisher.publish([MOTOR.pack(b"\0\1\0\0", *stamp(time.monotonic_ns()))])

    return send


def watch(middleware: Middleware, ages: list[int]) -> None:
    """Record the age of every message on /imu_data, on the middleware's thread."""

    def take(messages: Sequence[bytes]) -> None:
        now = time.monotonic_ns()
        ages.extend(age_ns(high, low, now) for high, low in map(STAMP_IN_IMU.unpack_from, messages))

    middleware.subscribe("/imu_data", ImuSensorInformation, Qos(depth=1000), take)


def main(arguments: list[str]) -> None:
    """Answer lines until stdin ends."""
    with open_middleware("rclpy", NodeIdentity("bench")) as middleware:
        if arguments == ["load"]:
            answer(samples(middleware))
        else:
            ages: list[int] = []
            watch(middleware, ages)
            answer_ages(ages)


if __name__ == "__main__":
    main(sys.argv[1:])
