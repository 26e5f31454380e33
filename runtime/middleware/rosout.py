"""The topic ``/rosout``: every ROS 2 node publishes the lines of its log there."""

from __future__ import annotations

import contextlib
import logging

from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Qos
from roverlink.runtime.interfaces import Time
from roverlink.runtime.interfaces.rcl_interfaces import Log
from roverlink.runtime.middleware.protocol import Middleware, NodeIdentity

TOPIC = "/rosout"
QOS = Qos(durability="transient_local", depth=1000)  # rmw_qos_profile_rosout_default


class RosoutHandler(logging.Handler):
    """Log handler that publishes the records of a logger on a ROS 2 topic, usually ``/rosout``, until it is closed.

    Close it before the middleware.
    """

    def __init__(self, logger: logging.Logger, middleware: Middleware, topic: str, node: NodeIdentity) -> None:
        super().__init__()
        self._publisher = middleware.publisher(topic, Log, QOS)
        # rcl names the logger of a node so: /rover/udp_forwarder is rover.udp_forwarder.
        self._name = node.full_name.removeprefix("/").replace("/", ".")
        self._logger = logger
        logger.addHandler(self)

    def emit(self, record: logging.LogRecord) -> None:
        """Publish a record as a rcl_interfaces/msg/Log; `logging` calls this."""
        # The line is on the console too, and a warning about it would come back here. No error may reach the caller: it
        # would end the thread that logs.
        with contextlib.suppress(Exception):
            log = Log(
                Time.since_1970(round(record.created * 1e9)),
                record.levelno,
                self._name,
                record.getMessage(),
                record.pathname,
                record.funcName or "",
                record.lineno,
            )
            self._publisher.publish([cdr.encode(log)])

    def close(self) -> None:
        """Remove this handler from the logger, so that it publishes no more records."""
        self._logger.removeHandler(self)
        super().close()
