"""Declarations of the nodes of ``roverlink objects track`` and ``roverlink objects select``."""

from __future__ import annotations

from roverkit.node.shared_topics import LISTENED_TRANSFORMS
from roverlink.nodes import Direction, NodeDeclaration, RowTopic, Topic
from roverlink.runtime.core.handler import Qos
from roverlink.runtime.interfaces.geometry_msgs import PoseStamped, PoseWithCovarianceStamped
from roverlink.runtime.interfaces.sensor_msgs import CompressedImage
from roverlink.runtime.interfaces.std_msgs import String
from roverlink.runtime.interfaces.vision_msgs import Detection2DArray, Detection3DArray

DETECTED = RowTopic(
    "detected_object",
    Direction.PUBLISHED,
    "objects for the basestation",
    inbound=False,
    fields=("frame_id", "total_count", "index", "id", "type", "bbox", "confidence"),
)
DETECTIONS = Topic("objects/detections", (Detection2DArray,), Direction.PUBLISHED, "boxes, classes and numbers")
DETECTIONS_3D = Topic(
    "objects/detections_3d", (Detection3DArray,), Direction.PUBLISHED, "positions, with a depth camera"
)
IMAGE = Topic(
    "objects/image/compressed",
    (CompressedImage,),
    Direction.PUBLISHED,
    "the image with the boxes",
    Qos(depth=5),  # the depth of ROS 2's profile for sensor data
)
TRACKER = NodeDeclaration("object_tracker", (DETECTED, DETECTIONS, DETECTIONS_3D, IMAGE), takes_images=True)

SELECTION = RowTopic(
    "object_selection",
    Direction.RECEIVED,
    "number of the object that the operator selects",
    inbound=True,
    fields=("object_id",),
)
LOCATED = DETECTIONS_3D.received("positions of the objects, from `roverlink objects track`", Qos(depth=5))
POSE = Topic("selected_object/pose", (PoseStamped,), Direction.PUBLISHED, "position in `base_link` (`--base-frame`)")
POSE_WITH_COVARIANCE = Topic(
    "selected_object/pose_with_covariance",
    (PoseWithCovarianceStamped,),
    Direction.PUBLISHED,
    "the same, with its uncertainty",
)
MAP_POSE = Topic("selected_object/map/pose", (PoseStamped,), Direction.PUBLISHED, "position in `map` (`--map-frame`)")
MAP_POSE_WITH_COVARIANCE = Topic(
    "selected_object/map/pose_with_covariance",
    (PoseWithCovarianceStamped,),
    Direction.PUBLISHED,
    "the same, with its uncertainty",
)
STATE = Topic(
    "selected_object/state",
    (String,),
    Direction.PUBLISHED,
    "`visible 3`, `held 3`, `lost 3`, `refused 7` or `none`; kept for late subscribers",
    Qos(depth=1, durability="transient_local"),
)
SELECTOR = NodeDeclaration(
    "object_selection",
    (
        *(SELECTION, LOCATED, *LISTENED_TRANSFORMS),
        *(POSE, POSE_WITH_COVARIANCE, MAP_POSE, MAP_POSE_WITH_COVARIANCE, STATE),
    ),
)
