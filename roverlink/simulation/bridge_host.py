"""Bridge for demo and simulation: a separate process in ROS 2, or a thread of this process without ROS 2."""

from __future__ import annotations

import json
import logging
import os
import signal
import subprocess
import sys
import threading
from pathlib import Path
from typing import IO, Any, Protocol, cast

from roverlink.runtime import NODE, Bridge, Registry, SetupError
from roverlink.runtime.middleware import Middleware, NodeIdentity, open_middleware
from roverlink.runtime.middleware.memory import Graph, MemoryMiddleware
from roverlink.runtime.ros_arguments import parameters

_STOP_TIMEOUT_S = 20.0  # on a busy machine it may take long to handle the datagrams that have arrived


class BridgeHost(Protocol):
    """Bridge that was started for a demo or simulation. A context manager."""

    port: int
    """UDP port on which the bridge listens."""
    pid: int
    """Id of the process in which the bridge runs."""

    def middleware(self, node: NodeIdentity) -> Middleware:
        """Return a middleware for a node that exchanges messages with the bridge."""

    def stop(self) -> dict[str, Any]:
        """Stop the bridge and return its counters, as `Account.as_dict` does."""

    def __enter__(self) -> BridgeHost: ...

    def __exit__(self, *_: object) -> None: ...


def bridge_with(
    middleware: str, project: Path, registry: Registry, ports: dict[str, int], log_level: str = "warn"
) -> BridgeHost:
    """Return a bridge that uses a middleware, and sends datagrams to these ports of the peers."""
    if middleware == "memory":
        return BridgeThread(registry, ports, log_level)
    return BridgeProcess(project, middleware, ports, log_level)


class BridgeProcess:
    """``roverlink run`` as a child process, over ``dds`` or ``rclpy``."""

    def __init__(self, project: Path, middleware: str, ports: dict[str, int], log_level: str = "warn") -> None:
        self._middleware = middleware
        command = [sys.executable, "-m", "roverlink", "run", "--json", "--middleware", middleware]
        command += [
            "--project",
            str(project),
            "--ros-args",
            "-p",
            "listen_port:=0",
            "-p",
            "listen_address:='127.0.0.1'",
        ]
        command += ["--log-level", log_level]
        for name, port in ports.items():
            command += ["-p", f"{name}:={port}"]
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
        """Return the same middleware that the bridge uses."""
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
    """Bridge on a thread of this process, which uses the middleware `memory`."""

    def __init__(self, registry: Registry, ports: dict[str, int], log_level: str = "warn") -> None:
        self._graph = Graph()
        settings = parameters.read(registry, {"listen_port": 0, "listen_address": "127.0.0.1", **ports})
        logger = logging.getLogger("bridge")
        logger.setLevel(log_level.upper())
        self._bridge = Bridge(registry, settings, MemoryMiddleware(self._graph), NodeIdentity(NODE).topic, logger)
        self.port, self.pid = self._bridge.port, os.getpid()
        self._thread = threading.Thread(target=self._bridge.run, daemon=True)

    def __enter__(self) -> BridgeThread:
        self._bridge.__enter__()
        self._thread.start()
        return self

    def middleware(self, node: NodeIdentity) -> Middleware:  # noqa: ARG002  # memory has no nodes
        """Return a memory middleware that is connected to the bridge."""
        return MemoryMiddleware(self._graph)

    def stop(self) -> dict[str, Any]:
        """Stop the bridge after it has handled the datagrams that have arrived; return its counters."""
        self._bridge.stop()
        self._thread.join()
        return self._bridge.account.as_dict()

    def __exit__(self, *_: object) -> None:
        self._bridge.__exit__(None, None, None)
