"""Listener to the transforms of ROS 2: the topics /tf and /tf_static."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from roverkit.node.shared_topics import RECEIVED_TRANSFORMS, STATIC_TRANSFORMS
from roverkit.vision.poses.pose import Pose, rotation_of_quaternion
from roverkit.vision.poses.transform_tree import TransformTree
from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import ConversionError
from roverlink.runtime.core.standard_handler import nanoseconds
from roverlink.runtime.interfaces.geometry_msgs import TransformStamped
from roverlink.runtime.interfaces.tf2_msgs import TFMessage
from roverlink.runtime.middleware import Middleware

_UNIT = 0.01  # largest deviation of a quaternion's length from 1


class TransformListener:
    """Listener that keeps the transforms on /tf and /tf_static in a tree."""

    def __init__(
        self, middleware: Middleware, topic: Callable[[str], str], say: Callable[[str], None] = lambda _: None
    ) -> None:
        """Subscribe to the transforms; `topic` returns the fully qualified name of a topic.

        `say` is called with a message about the first transform that cannot be used.
        """
        self.tree = TransformTree()
        """Transforms that have come."""
        self._say, self._said = say, False
        RECEIVED_TRANSFORMS.subscribe(middleware, topic, partial(self._take, static=False))
        STATIC_TRANSFORMS.subscribe(middleware, topic, partial(self._take, static=True))

    def _take(self, messages: Sequence[bytes], *, static: bool) -> None:
        """Add transforms, on a thread of the middleware."""
        for data in messages:
            try:
                for transform in cdr.decode(TFMessage, data).transforms:
                    self._add(transform, static)
            except ConversionError as error:
                if not self._said:
                    self._said = True
                    self._say(f"ignoring transforms: {error}")

    def _add(self, transform: TransformStamped, static: bool) -> None:
        turn, way = transform.transform.rotation, transform.transform.translation
        quaternion = np.array([turn.x, turn.y, turn.z, turn.w])
        translation = np.array([way.x, way.y, way.z])
        if not (np.isfinite(translation).all() and abs(float(np.linalg.norm(quaternion)) - 1) <= _UNIT):
            raise ConversionError(
                f"the transform from {transform.child_frame_id!r} to {transform.header.frame_id!r} is not one"
            )
        pose = Pose(rotation_of_quaternion(quaternion), translation)
        # Frames had a slash in front in ROS 1, and some drivers still write it.
        parent, child = transform.header.frame_id.lstrip("/"), transform.child_frame_id.lstrip("/")
        self.tree.add(parent, child, nanoseconds(transform.header.stamp), pose, static=static)
