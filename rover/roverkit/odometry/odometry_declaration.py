"""Declaration of the node of ``roverlink odometry``."""

from __future__ import annotations

from dataclasses import asdict, replace

from roverkit.driving import drive_declaration
from roverkit.node import shared_topics
from roverkit.odometry.dead_reckoning import OdometryNoise
from roverlink.nodes import Direction, NodeDeclaration, Parameter, RowTopic, Topic, Transform
from roverlink.runtime.core.handler import Qos
from roverlink.runtime.interfaces.nav_msgs import Odometry
from roverlink.runtime.interfaces.sensor_msgs import Imu

WHEELS = tuple(f"{place}_{side}_motor" for side in ("left", "right") for place in ("front", "middle", "back"))
"""Fields of the diagnostics: the motors of the wheels."""
COMMAND = replace(drive_declaration.COMMAND, direction=Direction.RECEIVED, meaning="commands for the driving board")
PROGRESS = RowTopic(
    "drive_progress",
    Direction.RECEIVED,
    "distance left on the current command",
    inbound=True,
    fields=("distance_left",),
)
ODOMETER = "odometer"
"""Field of the reports with the signed distance in metres since the start of the board, if the project has it."""
DIAGNOSTICS = RowTopic("drive_diag", Direction.RECEIVED, "speeds of the wheels' motors", inbound=True, fields=WHEELS)
IMU = Topic(
    "imu/data_raw",
    (Imu,),
    Direction.RECEIVED,
    "angular velocity about z, which points up",
    Qos("best_effort", depth=50),  # best effort, so that it matches every publisher
)
ODOMETRY = Topic(
    "odometry/wheel",
    (Odometry,),
    Direction.PUBLISHED,
    "pose in the frame `odom`, velocity in `base_link`, and their covariances",
)
TRANSFORM = shared_topics.transforms("transform from `odom` to `base_link`, unless `publish_tf` is false")

_NOISE = asdict(OdometryNoise())
_FRAME = Parameter("odom_frame", str, "frame in which the pose of the rover is", "odom")
_BASE = Parameter("base_frame", str, "frame of the rover", "base_link")
_PUBLISH = Parameter(
    "publish_tf",
    bool,
    "true to publish the transform; set it to false if robot_localization publishes it",
    default=True,
)
NODE = NodeDeclaration(
    "odometry",
    (COMMAND, PROGRESS, DIAGNOSTICS, IMU, ODOMETRY, TRANSFORM, shared_topics.DIAGNOSTICS),
    (
        _FRAME,
        _BASE,
        _PUBLISH,
        Parameter("smallest_radius", float, "smallest turning radius of the driving board in metres", 1.0),
        Parameter(
            "straight_radius", float, "turning_radius in metres that the driving board takes for a straight line", 0.0
        ),
        Parameter(
            "distance_scale",
            float,
            "true distance, as a part of the distance that the driving board reports; `--tape` measures it",
            1.0,
        ),
        Parameter("slip", float, "standard deviation of the distance in metres, after one metre", _NOISE["slip"]),
        Parameter(
            "side_slip",
            float,
            "standard deviation of the motion to the side in metres, after one metre",
            _NOISE["side_slip"],
        ),
        Parameter(
            "yaw_slip",
            float,
            "standard deviation of the turn in radians, after one metre without an IMU",
            _NOISE["yaw_slip"],
        ),
        Parameter(
            "mean_slip",
            float,
            "standard deviation of the mean of the slip, as a part of the distance; smaller after a tape test",
            _NOISE["mean_slip"],
        ),
        Parameter("gyro_noise", float, "noise density of the gyroscope, in rad/s per √Hz", _NOISE["gyro_noise"]),
        Parameter("gyro_bias", float, "standard deviation of its bias at the start, in rad/s", _NOISE["gyro_bias"]),
        Parameter("gyro_bias_walk", float, "change of its bias in rad/s, after one second", _NOISE["gyro_bias_walk"]),
        Parameter("gyro_scale", float, "standard deviation of its relative scale error", _NOISE["gyro_scale"]),
    ),
    transforms=(Transform(_FRAME, _BASE, _PUBLISH),),
)
