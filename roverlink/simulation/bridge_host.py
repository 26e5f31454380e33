"""Bridge for `roverlink demo` and `roverlink simulate`: a child process in ROS 2, or a thread without ROS 2."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import IO, Any, Protocol, cast

from roverlink.console import node_logger
from roverlink.runtime import NODE, Bridge, Registry, SetupError
from roverlink.runtime.bridge.signed_peers import open_links
from roverlink.runtime.middleware import NAMES, Middleware, NodeIdentity, open_middleware
from roverlink.runtime.middleware.memory import Graph, MemoryMiddleware
from roverlink.runtime.ros_arguments import parameters

MIDDLEWARES = tuple(name for name in NAMES if name != "auto")
"""Middlewares with which `bridge_with` starts a bridge."""
_ON_LOOPBACK: dict[str, str | int] = {"listen_port": 0, "listen_address": "127.0.0.1"}
_STOP_TIMEOUT_S = 20.0  # on a busy machine it may take long to handle the datagrams that have arrived


class BridgeHost(Protocol):
    """Bridge that is started for a demo or a simulation.

    A context manager: the bridge starts on entry, and ends on exit at the latest.
    """

    port: int
    """UDP port on which the bridge listens."""
    pid: int
    """Id of the process in which the bridge runs."""

    def middleware(self, node: NodeIdentity) -> Middleware:
        """Return a connection to the bridge's topics for the node ``node`` of this process."""

    def stop(self) -> dict[str, Any]:
        """Stop the bridge and return its counters: the result of `roverlink.runtime.bridge.account.Account.as_dict`."""

    def __enter__(self) -> BridgeHost: ...

    def __exit__(self, *_: object) -> None: ...


def bridge_with(
    middleware: str,
    project: Path,
    registry: Registry,
    given: dict[str, str | int],
    log_level: str = "warn",
    key_files: Sequence[Path] = (),
) -> BridgeHost:
    """Return a bridge for a project; it starts when it is entered as a context manager.

    ``middleware`` is ``dds``, ``rclpy`` or ``memory``; with ``memory`` the bridge is a thread, else a child process.
    ``given`` are parameters of the bridge: the hosts and ports of the simulated peers. ``key_files`` has the keys of
    the peers that must sign.
    """
    if middleware == "memory":
        return BridgeThread(registry, given, log_level, key_files)
    return BridgeProcess(project, middleware, given, log_level, key_files)


class BridgeProcess:
    """Bridge as a child process ``roverlink run``, which uses the middleware ``dds`` or ``rclpy``."""

    def __init__(
        self,
        project: Path,
        middleware: str,
        given: dict[str, str | int],
        log_level: str = "warn",
        key_files: Sequence[Path] = (),
    ) -> None:
        self._middleware = middleware
        command = [sys.executable, "-m", "roverlink", "run", "--json", "--middleware", middleware]
        for file in key_files:
            command += ["--key-file", str(file)]
        command += ["--project", str(project), "--ros-args", "--log-level", log_level]
        for name, value in {**_ON_LOOPBACK, **given}.items():
            # In YAML, a text in quotes stays a text.
            command += ["-p", f"{name}:={value!r}"]
        self._command = command
        self.port = self.pid = 0

    def __enter__(self) -> BridgeProcess:
        self._child = subprocess.Popen(  # noqa: S603  # our own program
            self._command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
        self.pid = self._child.pid
        self._output = cast(IO[str], self._child.stdout)
        self._log = cast(IO[str], self._child.stderr)
        # A thread has to read stderr, or the child would block when the pipe is full.
        threading.Thread(target=self._pass_on, daemon=True).start()
        ready = self._output.readline()
        if not ready:
            self._child.wait()
            raise SetupError("the bridge process did not start; see its messages above")
        self.port = json.loads(ready)["port"]
        return self

    def _pass_on(self) -> None:
        """Print the warnings and errors that the child process logs."""
        for line in self._log:
            if not line.startswith("[INFO]"):
                sys.stderr.write(line)

    def middleware(self, node: NodeIdentity) -> Middleware:
        """Return a connection to ROS 2 for the node ``node``, through the same middleware as the bridge's."""
        return open_middleware(self._middleware, node)

    def stop(self) -> dict[str, Any]:
        """Stop the child process as Ctrl-C does, and return the bridge's counters.

        Raises `SetupError` if the child process fails or does not stop.
        """
        self._child.send_signal(signal.SIGINT)
        try:
            code = self._child.wait(_STOP_TIMEOUT_S)  # no deadlock: its output is far smaller than a pipe's buffer
        except subprocess.TimeoutExpired as error:
            raise SetupError(f"the bridge did not stop within {_STOP_TIMEOUT_S} s") from error
        if code:
            raise SetupError(f"the bridge ended with exit code {code}")
        account: dict[str, Any] = json.load(self._output)
        return account

    def __exit__(self, *_: object) -> None:
        if self._child.poll() is None:
            self._child.kill()
            self._child.wait()


class BridgeThread:
    """Bridge on a thread of this process. It uses the middleware ``memory``, whose topics need no ROS 2."""

    def __init__(
        self,
        registry: Registry,
        given: dict[str, str | int],
        log_level: str,
        key_files: Sequence[Path] = (),
    ) -> None:
        self._graph = Graph()
        settings = parameters.read(registry, {**_ON_LOOPBACK, **given})
        logger = node_logger(NODE, log_level)
        self._links = open_links(registry, key_files, logger)
        middleware = MemoryMiddleware(self._graph)
        self._bridge = Bridge(registry, settings, middleware, NodeIdentity(NODE).topic, logger, links=self._links)
        self.port, self.pid = self._bridge.port, os.getpid()
        self._thread = threading.Thread(target=self._bridge.run, daemon=True)
        self._stack = ExitStack()

    def __enter__(self) -> BridgeThread:
        if self._links is not None:
            self._stack.enter_context(self._links)
        self._stack.enter_context(self._bridge)
        self._thread.start()
        return self

    def middleware(self, node: NodeIdentity) -> Middleware:  # noqa: ARG002  # memory has no nodes
        """Return a middleware ``memory`` that has the same topics as the bridge; the node's name is not used."""
        return MemoryMiddleware(self._graph)

    def stop(self) -> dict[str, Any]:
        """Stop the bridge after it has handled the datagrams that have arrived; return its counters."""
        self._bridge.stop()
        self._thread.join()
        self._stack.close()  # its timers send datagrams until it is closed
        return self._bridge.account.as_dict()

    def __exit__(self, *_: object) -> None:
        self._stack.close()
