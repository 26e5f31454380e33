"""The topic ``/rosout``: every ROS 2 node publishes the lines of its log there."""

from __future__ import annotations

import contextlib
import logging

from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import RoverlinkError
from roverlink.runtime.core.handler import Qos
from roverlink.runtime.interfaces import Time
from roverlink.runtime.interfaces.rcl_interfaces import Log
from roverlink.runtime.middleware.protocol import Middleware, NodeIdentity

TOPIC = "/rosout"
_QOS = Qos(durability="transient_local", depth=1000)  # rmw_qos_profile_rosout_default
_NS = 1_000_000_000


class RosoutHandler(logging.Handler):
    """Publishes the records of a logger until it is closed. Close it before the middleware."""

    def __init__(self, logger: logging.Logger, middleware: Middleware, topic: str, node: NodeIdentity) -> None:
        super().__init__()
        self._publisher = middleware.publisher(topic, Log, _QOS)
        # rcl names the logger of a node so: /rover/udp_forwarder is rover.udp_forwarder.
        self._name = node.full_name.removeprefix("/").replace("/", ".")
        self._logger = logger
        logger.addHandler(self)

    def emit(self, record: logging.LogRecord) -> None:
        """Publish a record; `logging` calls this."""
        log = Log(
            Time(*divmod(round(record.created * _NS), _NS)),
            record.levelno,
            self._name,
            record.getMessage(),
            record.pathname,
            record.funcName or "",
            record.lineno,
        )
        # The line is on the console too, and a warning about it would come back here.
        with contextlib.suppress(RoverlinkError):
            self._publisher.publish([cdr.encode(log)])

    def close(self) -> None:
        """Publish no more records."""
        self._logger.removeHandler(self)
        super().close()
