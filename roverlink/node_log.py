"""Publication of a node's log on the topic ``/rosout``, as ROS 2 nodes do."""

from __future__ import annotations

import logging
from contextlib import ExitStack, closing

from roverlink.runtime.middleware import Middleware
from roverlink.runtime.middleware.rosout import TOPIC, RosoutHandler
from roverlink.runtime.ros_arguments.ros_args import RosArguments


def publish_log(logger: logging.Logger, middleware: Middleware, ros: RosArguments) -> ExitStack:
    """Publish the log of a node on ``/rosout`` until the returned exit stack is closed.

    Nothing is published if the node's ROS arguments contain ``--disable-rosout-logs``. Close the stack before the
    middleware, because the middleware's publisher sends the log.
    """
    published = ExitStack()
    if ros.logs_to_rosout:
        published.enter_context(closing(RosoutHandler(logger, middleware, ros.topic(TOPIC), ros.node)))
    return published
