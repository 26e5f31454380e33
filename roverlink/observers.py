"""Observers that `roverlink run` attaches to a bridge: diagnostics, metrics, Foxglove and the recorder.

They are attached before the bridge starts: as an `Observer` of the bridge, or as a wrapper of the middleware. A bridge
without observers does no extra work.
"""

from __future__ import annotations

import argparse
import logging
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path

from roverlink.console import megabytes, port
from roverlink.runtime import Bridge, MiddlewareError, Registry, SetupError
from roverlink.runtime.bridge.bridge import Observer
from roverlink.runtime.middleware import Middleware
from roverlink.runtime.middleware.tapping import TappedMiddleware
from roverlink.runtime.monitoring import diagnostic_array
from roverlink.runtime.monitoring.foxglove_server import PORT as FOXGLOVE_PORT
from roverlink.runtime.monitoring.foxglove_server import FoxgloveServer
from roverlink.runtime.monitoring.histogram import LatencyProbe
from roverlink.runtime.monitoring.monitor import Monitor
from roverlink.runtime.monitoring.state import Recording
from roverlink.runtime.recording import COMPRESSIONS
from roverlink.runtime.ros_arguments.parameters import Parameters
from roverlink.runtime.ros_arguments.ros_args import RosArguments

RECORDING_HELP = (
    "file for the recorded topics, such as run.mcap (datagrams go to run.datagrams.mcap). If FILE is a folder, a file "
    "that is named after the date and time is created in it"
)


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options that attach observers to a parser. `roverlink run` and `roverlink record` have these options."""
    parser.add_argument(
        "--no-diagnostics", action="store_true", help="do not publish the bridge's state on the topic /diagnostics"
    )
    parser.add_argument("--metrics", type=port, metavar="PORT", help="serve metrics for Prometheus on this TCP port")
    parser.add_argument(
        "--foxglove",
        type=port,
        nargs="?",
        const=FOXGLOVE_PORT,
        metavar="PORT",
        help=f"show the topics live in Foxglove, which connects to this TCP port (default: {FOXGLOVE_PORT})",
    )
    parser.add_argument(
        "--rotate",
        type=megabytes,
        metavar="MB",
        help="start a new file when the current file of the recording has this size in megabytes (default: never)",
    )
    parser.add_argument(
        "--compression",
        choices=COMPRESSIONS,
        default="zstd",
        help="compression of the recording's files (default: %(default)s)",
    )


class BridgeObservers:
    """All observers of one bridge. They are opened on an exit stack, which closes them."""

    def __init__(
        self,
        arguments: argparse.Namespace,
        registry: Registry,
        ros: RosArguments,
        settings: Parameters,
        logger: logging.Logger,
        stack: ExitStack,
    ) -> None:
        self._arguments, self._registry, self._ros, self._settings = arguments, registry, ros, settings
        self._logger, self._stack = logger, stack
        self._probe = LatencyProbe()
        self.observers: list[Observer] = []
        self._recording: Callable[[], Recording | None] = lambda: None
        if self._monitored:
            self.observers.append(self._probe)

    @property
    def _monitored(self) -> bool:
        return not self._arguments.no_diagnostics or self._arguments.metrics is not None

    def wrap(self, middleware: Middleware) -> Middleware:
        """Return the middleware, wrapped so that the recorder and Foxglove get all messages if the options request it.

        Raises `SetupError` if a file cannot be written or a port is not available.
        """
        if self._arguments.record is not None:
            middleware = self._recorded(middleware, self._arguments.record)
        if self._arguments.foxglove is not None:
            address = self._settings.listen_address
            server = self._stack.enter_context(FoxgloveServer(self._ros.node.name, address, self._arguments.foxglove))
            self._logger.info("connect Foxglove to ws://%s:%d", address, server.port)
            middleware = TappedMiddleware(middleware, server)
        self._middleware = middleware
        return middleware

    def monitor(self, bridge: Bridge) -> ExitStack:
        """Start the monitoring of a bridge, and return the exit stack that ends the monitoring.

        Close this stack before the bridge, because the bridge closes the topics on which the monitoring publishes.
        """
        watch = ExitStack()
        if not self._monitored:
            return watch
        monitor = Monitor(self._ros.node.name, self._registry, bridge, self._probe, self._recording)
        if not self._arguments.no_diagnostics:
            topic = self._ros.topic(diagnostic_array.TOPIC)
            try:
                monitor.add_listener(diagnostic_array.publisher(self._middleware, topic))
            except MiddlewareError as error:
                self._logger.warning("cannot publish diagnostics on %s: %s", topic, error)
        if self._arguments.metrics is not None:
            from roverlink.runtime.monitoring.prometheus import (
                MetricsServer,
            )  # imported here: its HTTP server is slow to import

            address = self._settings.listen_address
            server = watch.enter_context(MetricsServer(address, self._arguments.metrics, monitor.state))
            self._logger.info("metrics: http://%s:%d/metrics", address, server.port)
        watch.enter_context(monitor)
        return watch

    def _recorded(self, middleware: Middleware, path: Path) -> Middleware:
        from roverlink.runtime.recording.datagram_tap import DatagramTap
        from roverlink.runtime.recording.queued_file import Settings
        from roverlink.runtime.recording.recorder import Recorder

        rows = {self._ros.topic(handler.route.topic): handler.route.name for handler in self._registry.handlers}
        settings = Settings(self._arguments.compression, self._arguments.rotate)
        try:
            recorder = Recorder(path, self._registry, rows, self._logger, settings, {"node": self._ros.node.full_name})
            self._stack.enter_context(recorder)
        except OSError as error:
            raise SetupError(f"{path}: cannot write the file: {error.strerror}") from error
        self._logger.info("recording to %s", recorder.path)
        self._recording = lambda: Recording(
            str(recorder.path), recorder.waiting, recorder.lost, recorder.bytes, recorder.failure
        )
        self.observers.append(DatagramTap(recorder, self._registry))
        return TappedMiddleware(middleware, recorder)
