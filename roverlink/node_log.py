"""The log of our nodes on the topic ``/rosout``."""

from __future__ import annotations

import logging
from contextlib import ExitStack, closing

from roverlink.runtime.middleware import Middleware
from roverlink.runtime.middleware.rosout import TOPIC, RosoutHandler
from roverlink.runtime.ros_arguments.ros_args import RosArguments


def publish_log(logger: logging.Logger, middleware: Middleware, ros: RosArguments) -> ExitStack:
    """Publish the log of a node, unless its arguments turn this off, until the returned stack is closed.

    Close the stack before the middleware.
    """
    published = ExitStack()
    if ros.logs_to_rosout:
        published.enter_context(closing(RosoutHandler(logger, middleware, ros.topic(TOPIC), ros.node)))
    return published
