"""Declaration of the node of ``roverlink aruco track``."""

from __future__ import annotations

from roverkit.node.shared_topics import LISTENED_TRANSFORMS, transforms
from roverlink.nodes import Direction, ExtraTopics, NodeDeclaration, Parameter, RowTopic, Topic
from roverlink.runtime.core.handler import Qos
from roverlink.runtime.interfaces.geometry_msgs import PoseWithCovarianceStamped
from roverlink.runtime.interfaces.sensor_msgs import CameraInfo, CompressedImage
from roverlink.runtime.interfaces.vision_msgs import Detection3DArray

_IMAGES = Qos(depth=5)  # the depth of ROS 2's profile for sensor data
TRANSFORMS = transforms(
    "the transform from the camera's frame to each landmark, such as `aruco_7`. The camera's frame is that of the "
    "images of a ROS 2 topic, else `camera_frame`; `--camera-frame NAME` and `--marker-frame PREFIX` change the names. "
    "With `--odom-frame`, also the transform from the frame of the field to that of the odometry"
)
MARKER_POSE = Topic(
    "aruco/<name>/pose",
    (PoseWithCovarianceStamped,),
    Direction.PUBLISHED,
    "the transform of one landmark, such as `aruco_7`, with its covariance",
)
DETECTIONS = Topic(
    "aruco/detections",
    (Detection3DArray,),
    Direction.PUBLISHED,
    "all landmarks of a frame, and all markers that share a number. The first result is the selected pose, the second "
    "one the other pose. The scores come from this frame alone",
)
CAMERA_INFO = Topic(
    "aruco/camera_info",
    (CameraInfo,),
    Direction.PUBLISHED,
    "the camera's parameters; images are not rectified",
    _IMAGES,
)
IMAGE = Topic(
    "aruco/image/compressed",
    (CompressedImage,),
    Direction.PUBLISHED,
    "the frame with the markers drawn into it, as JPEG, for RViz and Foxglove",
    _IMAGES,
)
CAMERA_POSE = Topic(
    "aruco/camera_pose",
    (PoseWithCovarianceStamped,),
    Direction.PUBLISHED,
    "with `--landmarks`: the pose of the camera, in the field's frame",
)
ROVER_POSE = Topic(
    "aruco/pose",
    (PoseWithCovarianceStamped,),
    Direction.PUBLISHED,
    "with `--landmarks` and a mount: the pose of `base_link` in the field's frame, for `robot_localization` and others",
)
POSITION = RowTopic(
    "rover_localization",
    Direction.PUBLISHED,
    "the same position: x, y and z of the rover in metres, which a running bridge sends to the basestation; held back "
    "while a filter publishes the fused position on an extra topic of the row",
    inbound=False,
    fields=("x", "y", "z"),
)
FUSED_POSITION = ExtraTopics(
    POSITION.row,
    "the fused position of a filter; for a second after each message, the position of the markers is held back",
)
NODE = NodeDeclaration(
    "aruco_tracker",
    (
        *(TRANSFORMS, MARKER_POSE, DETECTIONS, CAMERA_INFO, IMAGE, CAMERA_POSE, ROVER_POSE, POSITION),
        FUSED_POSITION,
        *LISTENED_TRANSFORMS,
    ),
    (
        Parameter("dictionary", str, "OpenCV's name of the dictionary of the markers"),
        Parameter("side", float, "side of a marker's black square in metres"),
        Parameter("sides", str, "other sides of single markers in metres, such as: 7=0.1, 8=0.2"),
        Parameter("landmarks", str, "YAML file with the poses of the landmarks on the field; empty for none"),
    ),
    takes_images=True,
    other_topics=("<camera>/aruco/<name>",),
)
