"""Declaration of the node of ``roverlink fuse``."""

from __future__ import annotations

from roverkit.aruco import tracker_declaration
from roverkit.node.shared_topics import DIAGNOSTICS, LISTENED_TRANSFORMS, transforms
from roverkit.odometry import odometry_declaration
from roverlink.nodes import Direction, NodeDeclaration, Topic
from roverlink.runtime.core.handler import Qos
from roverlink.runtime.interfaces.nav_msgs import Odometry
from roverlink.runtime.interfaces.sensor_msgs import NavSatFix

_QOS = Qos("best_effort", depth=10)  # matches every publisher
ODOMETRY = odometry_declaration.ODOMETRY.received("from `roverlink odometry`", _QOS)
DETECTIONS = tracker_declaration.DETECTIONS.received(
    "landmarks that `roverlink aruco track` sees. With `--cameras cameras.yaml`, those of each camera "
    "(`front/aruco/detections`)",
    _QOS,
)
FIX = Topic(
    "gps/fix",
    (NavSatFix,),
    Direction.RECEIVED,
    "with `--datum LATITUDE LONGITUDE HEADING`: position of the antenna, which is taken for that of `base_link`",
    _QOS,
)
FUSED = Topic(
    "odometry/global", (Odometry,), Direction.PUBLISHED, "pose on the field, with the velocity of the odometry"
)
TRANSFORM = transforms("transform from `map` to `odom`")
NODE = NodeDeclaration(
    "fusion",
    (ODOMETRY, DETECTIONS, FIX, *LISTENED_TRANSFORMS, FUSED, TRANSFORM, DIAGNOSTICS),
    other_topics=("<camera>/aruco/detections",),
)
