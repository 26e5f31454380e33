"""Observers that `roverlink run` attaches to a bridge: diagnostics, metrics, the page, Foxglove and the recorder.

They measure or record the messages that pass the bridge. To see datagrams, an observer is an `Observer` of the bridge.
To see messages of topics, it wraps the middleware that the bridge gets. A bridge without observers does no extra work.
"""

from __future__ import annotations

import argparse
import logging
import time
from collections.abc import Callable
from contextlib import ExitStack, closing
from pathlib import Path
from typing import TYPE_CHECKING

from roverlink import link_page
from roverlink.console import megabytes, port
from roverlink.runtime import Bridge, MiddlewareError, Registry, SetupError
from roverlink.runtime.bridge.bridge import Observer
from roverlink.runtime.middleware import Middleware
from roverlink.runtime.middleware.tapping import TappedMiddleware
from roverlink.runtime.monitoring import diagnostic_array
from roverlink.runtime.monitoring.foxglove_server import PORT as FOXGLOVE_PORT
from roverlink.runtime.monitoring.foxglove_server import FoxgloveServer
from roverlink.runtime.monitoring.liveness import SilenceLog
from roverlink.runtime.monitoring.monitor import Monitor
from roverlink.runtime.monitoring.state import Recording, State
from roverlink.runtime.recording import COMPRESSIONS
from roverlink.runtime.ros_arguments.parameters import Parameters
from roverlink.runtime.ros_arguments.ros_args import RosArguments
from roverlink.runtime.ros_time.clock import SYSTEM_CLOCK, Clock

if TYPE_CHECKING:
    from roverlink.link_page.live_link import LiveLink
    from roverlink.runtime.ros_arguments.live_parameters import LiveParameters

RECORDING_HELP = (
    "file for the recorded topics, such as run.mcap (datagrams go to run.datagrams.mcap beside it); if FILE is a "
    "folder, a file that is named after the date and time is created in it"
)
"""Help text of FILE, the path of the recording, for ``roverlink run --record FILE`` and ``roverlink record FILE``."""


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options for diagnostics, metrics, the page, Foxglove and the files of a recording to a parser.

    The commands `roverlink run` and `roverlink record` have these options.
    """
    parser.add_argument(
        "--no-diagnostics",
        action="store_true",
        help="do not publish the bridge's state on the topic /diagnostics (`roverlink top` needs it)",
    )
    parser.add_argument(
        "--metrics",
        type=port,
        metavar="PORT",
        help="serve metrics for Prometheus on this TCP port, under the path /metrics",
    )
    parser.add_argument(
        "--foxglove",
        type=port,
        nargs="?",
        const=FOXGLOVE_PORT,
        metavar="PORT",
        help="let the viewer Foxglove show the topics live; Foxglove connects to this TCP port "
        f"(without PORT: {FOXGLOVE_PORT})",
    )
    link_page.add_options(parser, "--page", "acknowledge alarms for all browsers, and set parameters of the bridge")
    parser.add_argument(
        "--foxglove-address",
        default="127.0.0.1",
        metavar="ADDRESS",
        help="with --foxglove: IPv4 address to listen on (default: %(default)s, which only this computer can reach; "
        "0.0.0.0: every computer that reaches this one, without a password)",
    )
    parser.add_argument(
        "--rotate",
        type=megabytes,
        metavar="MB",
        help="with a recording: start a new file when the current file has this size in megabytes (default: never)",
    )
    parser.add_argument(
        "--compression",
        choices=COMPRESSIONS,
        default="zstd",
        help="with a recording: compression of the files (default: %(default)s)",
    )


class BridgeObservers:
    """All observers of one bridge, as the options of the command line select them.

    Call `wrap` and give `observers` to the bridge before it starts. Call `monitor` after its start. The exit stack
    ``stack`` closes the recorder and the Foxglove server.
    """

    def __init__(
        self,
        arguments: argparse.Namespace,
        registry: Registry,
        ros: RosArguments,
        settings: Parameters,
        live: LiveParameters,
        logger: logging.Logger,
        stack: ExitStack,
    ) -> None:
        link_page.check_options("--page", arguments.page, arguments.page_token)
        self._arguments, self._registry, self._ros, self._settings = arguments, registry, ros, settings
        self._parameters = live
        self._logger, self._stack = logger, stack
        self.observers: list[Observer] = []
        """Observers of datagrams that the bridge gets when it is made; complete after the call of `wrap`."""
        self._recording: Callable[[], Recording | None] = lambda: None
        self._link: LiveLink | None = None

    @property
    def _monitored(self) -> bool:
        asked = (self._arguments.metrics, self._arguments.page)
        return not self._arguments.no_diagnostics or any(option is not None for option in asked)

    def wrap(self, middleware: Middleware) -> Middleware:
        """Wrap the middleware so that recorder, Foxglove and page get messages, if the options request them.

        Return the middleware to give to the bridge. Raises `SetupError` if a file cannot be written or a port is not
        available.
        """
        if self._arguments.record is not None:
            middleware = self._recorded(middleware, self._arguments.record)
        if self._arguments.foxglove is not None:
            address = self._arguments.foxglove_address
            server = self._stack.enter_context(FoxgloveServer(self._ros.node.name, address, self._arguments.foxglove))
            self._logger.info("connect Foxglove to %s", server.url)
            middleware = TappedMiddleware(middleware, server)
        if self._arguments.page is not None:
            middleware = self._shown(middleware, self._arguments.page)
        self._middleware = middleware
        return middleware

    def monitor(self, bridge: Bridge, clock: Clock = SYSTEM_CLOCK) -> ExitStack:
        """Start the diagnostics, metrics and page of a bridge, and return the exit stack that ends them.

        ``clock`` shows the time of the diagnostics.
        Close this stack before the bridge, because the bridge closes the topics on which the diagnostics are published.
        """
        watch = ExitStack()
        if not self._monitored:
            return watch
        monitor = Monitor(self._ros.node.name, self._registry, bridge, self._recording, logger=self._logger)
        silences = SilenceLog(self._logger)
        monitor.add_listener(lambda _: silences.take(monitor.liveness()))
        if not self._arguments.no_diagnostics:
            topic = self._ros.topic(diagnostic_array.TOPIC)
            try:
                name = self._ros.node.full_name
                monitor.add_listener(diagnostic_array.publisher(self._middleware, name, topic, clock))
            except MiddlewareError as error:
                self._logger.warning("cannot publish diagnostics on %s: %s", topic, error)
        if self._arguments.metrics is not None:
            from roverlink.runtime.monitoring.prometheus import (
                MetricsServer,
            )  # imported here: its HTTP server is slow to import

            address = self._settings.listen_address
            server = watch.enter_context(MetricsServer(address, self._arguments.metrics, monitor.state))
            self._logger.info("metrics: %smetrics", server.url)
        if self._link is not None:
            monitor.add_listener(self._show_state(self._link))
        watch.enter_context(monitor)
        return watch

    def _shown(self, middleware: Middleware, address: tuple[str, int]) -> Middleware:
        from roverlink.link_page.last_values import LastValues
        from roverlink.link_page.live_page import LivePage
        from roverlink.link_page.log_lines import LogLinesHandler

        page, values = LivePage(self._logger, self._parameters), LastValues(self._rows)
        self._link = page.add(self._ros.node.full_name, values)
        link_page.serve(page, address, self._arguments.page_token, self._stack, self._logger)
        self._stack.enter_context(closing(LogLinesHandler(self._logger, self._link.log)))
        return TappedMiddleware(middleware, values)

    @staticmethod
    def _show_state(link: LiveLink) -> Callable[[Callable[[], State]], None]:
        from roverlink.heard_bridges import state_of

        def show(state: Callable[[], State]) -> None:
            if (shown := state_of(diagnostic_array.array_of(state(), time.time_ns(), {}))) is not None:
                link.take_state(shown)

        return show

    @property
    def _rows(self) -> dict[str, str]:
        """Names of the rows by the full names of their own topics."""
        return {self._ros.topic(handler.route.topic): handler.route.name for handler in self._registry.handlers}

    def _recorded(self, middleware: Middleware, path: Path) -> Middleware:
        from roverlink.runtime.recording.datagram_tap import DatagramTap
        from roverlink.runtime.recording.queued_file import Settings
        from roverlink.runtime.recording.recorder import Recorder

        settings = Settings(self._arguments.compression, self._arguments.rotate)
        try:
            recorder = Recorder(
                path, self._registry, self._rows, self._logger, settings, {"node": self._ros.node.full_name}
            )
            self._stack.enter_context(recorder)
        except OSError as error:
            raise SetupError(f"{path}: cannot write the file: {error.strerror}") from error
        self._logger.info("recording to %s", recorder.path)
        self._recording = lambda: Recording(
            str(recorder.path), recorder.waiting, recorder.lost, recorder.bytes, recorder.failure
        )
        self.observers.append(DatagramTap(recorder, self._registry))
        return TappedMiddleware(middleware, recorder)
