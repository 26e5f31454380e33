"""Parameters of ``roverlink rocks measure``: the topics of the camera, which ROS 2 can change."""

from __future__ import annotations

import argparse
import logging
from collections.abc import Mapping
from typing import Any

from roverkit.node.declared_parameters import DeclaredParameters
from roverkit.node.ros_connection import full_topic
from roverkit.rocks.rocks_declaration import NODE
from roverkit.vision.frames.depth_camera import CameraTopics, aligned_depth_topic
from roverkit.vision.ros.camera_info import camera_info_topic
from roverlink.runtime.ros_arguments.ros_args import RosArguments


class CameraTopicParameters(DeclaredParameters[CameraTopics]):
    """Parameters of the node: the topics of the camera. Another ``camera`` sets the other ones to their defaults."""

    def __init__(self, arguments: argparse.Namespace, ros: RosArguments, logger: logging.Logger) -> None:
        """Read the first values. Raises `SetupError` if one of them is not the name of a topic."""
        options = {parameter.name: getattr(arguments, parameter.name) or "" for parameter in NODE.parameters}

        def read(values: Mapping[str, Any]) -> CameraTopics:
            colour = full_topic(values["camera"], ros)
            depth = values["depth"] or aligned_depth_topic(colour)
            info = values["camera_info"] or camera_info_topic(colour)
            return CameraTopics(colour, full_topic(depth, ros), full_topic(info, ros))

        super().__init__(NODE.parameters, options, ros, read, logger)

    def _completed(self, before: Mapping[str, Any], changes: Mapping[str, Any]) -> Mapping[str, Any]:
        # The depth of one camera with the parameters of another one would give wrong sizes.
        others = {"depth": "", "camera_info": ""} if "camera" in changes else {}
        return {**before, **others, **changes}
