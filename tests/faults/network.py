"""A rover and a board in network namespaces of their own, with a cable between them that can be cut.

A thread joins a namespace with setns(2), and the sockets that it makes there stay there: so a whole bridge runs in the
tests' own process. Needs root.
"""

from __future__ import annotations

import ctypes
import os
import shutil
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

T = TypeVar("T")

ROVER, BOARD = "10.99.0.1", "10.99.0.2"
_CLONE_NEWNET = 0x40000000


def why_not() -> str:
    """Why there can be no namespaces here; empty where there can."""
    if sys.platform != "linux" or os.geteuid() != 0:
        return "need network namespaces (Linux, as root)"
    try:
        made = subprocess.run(["unshare", "-n", "ip", "link", "show", "lo"], capture_output=True, check=False)
    except OSError as error:
        return f"need network namespaces ({error})"
    return "" if made.returncode == 0 else f"need network namespaces ({made.stderr.decode().strip()})"


def ip(*arguments: str) -> None:
    """Change the network; raises where that fails."""
    subprocess.run(["ip", *arguments], check=True, capture_output=True, text=True)


class Network:
    """Two namespaces, each with its end of a cable. A context manager."""

    def __init__(self) -> None:
        self._tag = f"rl{os.getpid()}"
        self.rover, self.board = f"{self._tag}r", f"{self._tag}b"

    def __enter__(self) -> Network:
        for name in (self.rover, self.board):
            ip("netns", "add", name)
            ip("-n", name, "link", "set", "lo", "up")
        ip("link", "add", "cable", "netns", self.rover, "type", "veth", "peer", "name", "cable", "netns", self.board)
        for name, address in ((self.rover, ROVER), (self.board, BOARD)):
            ip("-n", name, "address", "add", f"{address}/24", "dev", "cable")
            ip("-n", name, "link", "set", "cable", "up")
        return self

    def __exit__(self, *_: object) -> None:
        for name in (self.rover, self.board):
            ip("netns", "del", name)

    def inside(self, namespace: str, make: Callable[[], T]) -> T:
        """What a function makes in a namespace."""
        made: list[T] = []
        failures: list[BaseException] = []

        def run() -> None:
            try:
                _join(namespace)
                made.append(make())
            except BaseException as failure:  # noqa: BLE001  # raised below
                failures.append(failure)

        thread = threading.Thread(target=run)
        thread.start()
        thread.join()
        if failures:
            raise failures[0]
        return made[0]

    def impair(self, namespace: str, *netem: str) -> str:
        """Let tc(8) spoil what leaves a namespace; why it cannot, or nothing."""
        tc = shutil.which("tc", path=f"{os.environ['PATH']}:/usr/sbin:/sbin")  # not every user's path has it
        if tc is None:
            return "need tc (apt-get install iproute2)"
        command = [tc, "-n", namespace, "qdisc", "replace", "dev", "cable", "root", "netem", *netem]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        return "" if done.returncode == 0 else f"need netem in the kernel: {done.stderr.strip()}"


def _join(namespace: str) -> None:
    """Take the calling thread into a namespace."""
    with Path(f"/run/netns/{namespace}").open() as file:
        libc = ctypes.CDLL(None, use_errno=True)
        if libc.setns(file.fileno(), _CLONE_NEWNET):
            raise OSError(ctypes.get_errno(), f"cannot join {namespace}")
