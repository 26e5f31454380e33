"""The log of a node on /rosout."""

from __future__ import annotations

import logging
from collections.abc import Iterator, Sequence
from typing import Any

import pytest

from roverlink.runtime import MiddlewareError, Qos
from roverlink.runtime.core import cdr
from roverlink.runtime.interfaces.rcl_interfaces import Log
from roverlink.runtime.middleware import NodeIdentity
from roverlink.runtime.middleware.memory import Graph, MemoryMiddleware
from roverlink.runtime.middleware.rosout import TOPIC, RosoutHandler

_NODE = NodeIdentity("udp_forwarder", "/rover")


@pytest.fixture
def logger() -> Iterator[logging.Logger]:
    """A logger that prints nothing."""
    logger = logging.getLogger("test_rosout")
    logger.setLevel(logging.DEBUG)
    logger.propagate = False
    yield logger
    logger.handlers.clear()


def test_each_line_of_the_log_is_a_message(logger: logging.Logger) -> None:
    """A line has ROS 2's level, the name of the node's logger, the text, and the place that logged it."""
    graph, seen = Graph(), []
    MemoryMiddleware(graph).subscribe(TOPIC, Log, Qos(), seen.extend)
    RosoutHandler(logger, MemoryMiddleware(graph), TOPIC, _NODE)
    for level in ("debug", "info", "warning", "error", "critical"):
        getattr(logger, level)("%d datagrams", 3)
    logs = [cdr.decode(Log, data) for data in seen]
    assert [log.level for log in logs] == [10, 20, 30, 40, 50]
    assert {(log.name, log.msg, log.function) for log in logs} == {
        ("rover.udp_forwarder", "3 datagrams", "test_each_line_of_the_log_is_a_message")
    }
    assert all(log.file == __file__ and log.line and log.stamp.sec for log in logs)


class _Broken(MemoryMiddleware):
    def publisher(self, *_: object) -> Any:
        return self

    def publish(self, messages: Sequence[bytes], /) -> int:
        raise MiddlewareError("the middleware is broken")


@pytest.mark.parametrize("middleware", [_Broken(), MemoryMiddleware()])
def test_a_line_that_cannot_be_published_disturbs_nobody(logger: logging.Logger, middleware: Any) -> None:
    """Neither an error of the middleware nor a text without a UTF-8 form reaches the code that logs."""
    handler = RosoutHandler(logger, middleware, TOPIC, _NODE)
    handler.handle(logger.makeRecord(logger.name, logging.INFO, __file__, 1, "a file name: \udcff", (), None))
