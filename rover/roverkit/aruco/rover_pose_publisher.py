"""Publisher of the rover's pose on ROS 2 topics (REP 105)."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from roverkit.aruco.tracker_declaration import ROVER_POSE, TRANSFORMS
from roverkit.vision.localization.rover_localizer import RoverPose
from roverkit.vision.poses.transform_tree import TransformError, TransformTree
from roverkit.vision.ros.landmark_messages import field_pose_of, transform_of
from roverkit.vision.ros.outputs import Outputs
from roverlink.runtime.interfaces import tf2_msgs
from roverlink.runtime.middleware import Middleware


class RoverFrames(NamedTuple):
    """Names of the rover's coordinate frames."""

    base: str = "base_link"
    """Frame of the rover's body."""
    odom: str = ""
    """Frame of the odometry, to which a transform from the field's frame is published; empty for none."""


class RoverPosePublisher:
    """Publisher of the rover's pose, and of the transform to the frame of the odometry."""

    def __init__(
        self,
        middleware: Middleware,
        frames: RoverFrames,
        tree: TransformTree,
        topic: Callable[[str], str],
        say: Callable[[str], None],
    ) -> None:
        """Create the publishers; `topic` returns the fully qualified name of a topic.

        `tree` has the transforms of the odometry. `say` is called with a message if they are missing, or if ROS 2 lacks
        the type of a topic.
        """
        self._frames, self._tree, self._say = frames, tree, say
        self._said = ""
        outputs = Outputs(middleware, topic, say)
        self._pose = outputs.open(ROVER_POSE)
        self._transforms = outputs.open(TRANSFORMS) if frames.odom else None

    def publish(self, rover: RoverPose) -> None:
        """Publish the pose, and the transform to the odometry's frame if it is wanted and known."""
        self._pose.put(lambda: field_pose_of(rover.field_pose, rover.stamp))
        if self._transforms is None:
            return
        try:
            odom_to_base = self._tree.look_up(self._frames.base, self._frames.odom, rover.stamp)
        except TransformError as error:
            # Once for each reason: the age in the text changes with every frame.
            reason = str(error).partition(":")[0]
            if reason != self._said:
                self._said = reason
                self._say(
                    f"no transform from {rover.field_pose.frame!r} to {self._frames.odom!r} is published: {error}"
                )
            return
        self._said = ""
        found = rover.field_pose
        transform = transform_of(found.pose @ odom_to_base, found.frame, self._frames.odom, rover.stamp)
        self._transforms.publish(tf2_msgs.TFMessage([transform]))
