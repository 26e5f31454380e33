"""A bridge with its page, in this process: for the pictures of docs/operations.md and the tests of the page."""

from __future__ import annotations

import argparse
import contextlib
import logging
import socket
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from generated.registry import REGISTRY
from roverlink.generator.example_payloads import payload_at
from roverlink.observers import BridgeObservers
from roverlink.runtime import Bridge
from roverlink.runtime.core import cdr
from roverlink.runtime.middleware.memory import Graph, MemoryMiddleware
from roverlink.runtime.ros_arguments import parameters, ros_args
from roverlink.runtime.ros_arguments.live_parameters import LiveParameters

_TICK_S = 0.05


class WatchedLink:
    """A bridge with its page, a board that sends, and a node that publishes commands."""

    def __init__(
        self, url: str, bridge: Bridge, commands: MemoryMiddleware, logger: logging.Logger, lines: list[str]
    ) -> None:
        self.url, self.bridge, self.logger, self.lines = url, bridge, logger, lines
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        handler = REGISTRY.by_name["drive_motor"]
        self._drive = commands.publisher(f"/{handler.route.topic}", handler.message_type, handler.route.qos)
        self._start = time.monotonic()
        self._ending = threading.Event()
        self.boards_speak = self.driver_speaks = False
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def send(self, datagram: bytes) -> None:
        """Send a datagram to the bridge."""
        self._socket.sendto(datagram, ("127.0.0.1", self.bridge.port))

    def send_payload(self, name: str, **fields: Any) -> None:
        """Send a payload with these fields to the bridge; without fields, it has example values of this moment."""
        handler = REGISTRY.by_name[name]
        payload = handler.payload_type(**fields) if fields else payload_at(handler.payload_type, self._seconds)
        self.send(REGISTRY.envelope(**{name: payload}).SerializeToString())

    def command(self) -> None:
        """Publish one command for the drive."""
        handler = REGISTRY.by_name["drive_motor"]
        payload = payload_at(handler.payload_type, self._seconds)
        self._drive.publish([cdr.encode(handler.to_ros(payload))])

    @property
    def _seconds(self) -> float:
        return time.monotonic() - self._start

    def _run(self) -> None:
        inbound = [handler.route.name for handler in REGISTRY.handlers if handler.route.direction == "hardware_to_ros"]
        while not self._ending.wait(_TICK_S):
            if self.boards_speak:
                for name in inbound[:6]:
                    self.send_payload(name)
            if self.driver_speaks:
                self.command()

    def close(self) -> None:
        """End the board and the node."""
        self._ending.set()
        self._thread.join()
        self._socket.close()


def lines_of(logger: logging.Logger) -> list[str]:
    """Return a list that gets each line of a logger."""
    lines: list[str] = []
    handler = logging.Handler()
    handler.emit = lambda record: lines.append(record.getMessage())  # type: ignore[method-assign]  # of this one
    logger.addHandler(handler)
    return lines


def url_in(lines: list[str]) -> str:
    """Return the address of the page that was logged."""
    return next(text for text in lines if text.startswith("page: ")).removeprefix("page: ")


@contextlib.contextmanager
def watched_link(token_file: Path | None = None) -> Iterator[WatchedLink]:
    """Run a bridge without ROS 2, with its page on a free port; with ``token_file``, the page may act."""
    logger = logging.Logger("udp_forwarder", logging.INFO)  # one for each bridge, with its own handlers
    told = lines_of(logger)
    given = {"no_diagnostics": True, "metrics": None, "foxglove": None, "record": None}
    arguments = argparse.Namespace(**given, page=("127.0.0.1", 0), page_token=token_file)
    ros = ros_args.parse([], "udp_forwarder")
    settings = parameters.read(REGISTRY, {"listen_port": 0, "listen_address": "127.0.0.1"})
    parameters_now = LiveParameters(REGISTRY, settings, logger)
    graph = Graph()
    with contextlib.ExitStack() as stack:
        attached = BridgeObservers(arguments, REGISTRY, ros, settings, parameters_now, logger, stack)
        middleware = attached.wrap(MemoryMiddleware(graph))
        bridge = Bridge(REGISTRY, settings, middleware, ros.topic, logger, attached.observers)
        parameters_now.on_change(bridge.change)
        with bridge, attached.monitor(bridge):
            running = threading.Thread(target=bridge.run, daemon=True)
            running.start()
            link = WatchedLink(url_in(told), bridge, MemoryMiddleware(graph), logger, told)
            try:
                yield link
            finally:
                link.close()
                bridge.stop()
                running.join()
