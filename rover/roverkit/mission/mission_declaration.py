"""Declaration of the node of ``roverlink mission run``."""

from __future__ import annotations

from roverkit.aruco import tracker_declaration
from roverkit.driving.drive_declaration import MODE
from roverkit.node.shared_topics import LISTENED_TRANSFORMS
from roverlink.nodes import ActionClient, Direction, NodeDeclaration, RowTopic, Topic
from roverlink.runtime.core.handler import Qos
from roverlink.runtime.interfaces.std_msgs import String

STATE = Topic(
    "mission/state",
    (String,),
    Direction.PUBLISHED,
    "state and number of the goal, such as `driving 2`; kept for late subscribers",
    Qos(depth=1, durability="transient_local"),
)
PROGRESS = RowTopic(
    "mission_progress",
    Direction.PUBLISHED,
    "the same for the basestation, if the table has the row",
    inbound=False,
    fields=("state", "goal", "goals", "distance"),
)
DETECTIONS = tracker_declaration.DETECTIONS.received(
    "landmarks that `roverlink aruco track` sees; the file of the mission can name other topics", Qos(depth=5)
)
NAVIGATE = ActionClient("navigate_to_pose", "nav2_msgs/action/NavigateToPose")
BACK_UP = ActionClient("backup", "nav2_msgs/action/BackUp")
NODE = NodeDeclaration(
    "mission", (MODE, DETECTIONS, *LISTENED_TRANSFORMS, STATE, PROGRESS), actions=(NAVIGATE, BACK_UP)
)
