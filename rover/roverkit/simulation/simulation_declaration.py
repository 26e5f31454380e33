"""Declaration of the node of ``roverlink simulate-rover``, which takes no ROS arguments."""

from __future__ import annotations

from roverlink.nodes import Direction, NodeDeclaration, Topic
from roverlink.runtime.core.handler import Qos
from roverlink.runtime.interfaces.nav_msgs import Odometry
from roverlink.runtime.interfaces.rosgraph_msgs import Clock
from roverlink.runtime.interfaces.sensor_msgs import CameraInfo, Image

_IMAGES = Qos(depth=5)  # the depth of ROS 2's profile for sensor data
TRUTH = Topic(
    "ground_truth/odometry", (Odometry,), Direction.PUBLISHED, "true pose in the frame `map`, and true velocity"
)
CLOCK = Topic("/clock", (Clock,), Direction.PUBLISHED, "time of the simulation, with `--clock`", Qos(depth=1))
IMAGE = Topic(
    "camera/image_raw",
    (Image,),
    Direction.PUBLISHED,
    "two images a second of the markers in `--landmarks FILE`",
    _IMAGES,
)
CAMERA_INFO = Topic(
    "camera/camera_info", (CameraInfo,), Direction.PUBLISHED, "parameters of the camera, with `--landmarks`", _IMAGES
)
NODE = NodeDeclaration("simulated_rover", (TRUTH, CLOCK, IMAGE, CAMERA_INFO))
