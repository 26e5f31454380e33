"""Mounts of cameras on a rover: from the file of cameras, or from the transforms on /tf and /tf_static."""

from __future__ import annotations

import time
from collections.abc import Callable

from roverkit.vision.frames import Frame
from roverkit.vision.poses.pose import Pose
from roverkit.vision.poses.transform_tree import TransformError, TransformTree

PATIENCE_S = 3.0
"""Time in seconds without a transform after which the user is told: at the start, transforms come later than images."""


class MountOnTf:
    """Mount of a camera that is taken from the transforms, for each frame anew, because a camera may turn."""

    def __init__(self, tree: TransformTree, base_frame: str, say: Callable[[str], None]) -> None:
        """Take the mount from a tree. `say` is called with a message if the mount stays unknown."""
        self._tree, self._base, self._say = tree, base_frame, say
        self._missing_since: float | None = None
        self._said = False

    def __call__(self, frame: Frame) -> Pose | None:
        """Return the transform from the camera's optical frame to the rover's at the time of a frame, if known."""
        try:
            mount = self._tree.look_up(self._base, frame.frame_id, frame.stamp)
        except TransformError as error:
            self._miss(error)
            return None
        if self._said:
            self._say(f"the mount of the camera {frame.frame_id!r} is known now")
        self._missing_since, self._said = None, False
        return mount

    def _miss(self, error: TransformError) -> None:
        now = time.monotonic()
        if self._missing_since is None:
            self._missing_since = now
        if now - self._missing_since >= PATIENCE_S and not self._said:
            self._said = True
            self._say(
                f"the pose of {self._base!r} is not known: {error}; publish the camera's mount on /tf_static, or write "
                "it into cameras.yaml"
            )
