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
        return inside(namespace, make)

    def impair(self, namespace: str, *netem: str) -> str:
        """Let tc(8) spoil what leaves a namespace; why it cannot, or nothing."""
        return impair(namespace, "cable", *netem)


class RoverNetwork:
    """A rover, three boards on a switch, and a basestation behind a radio; a router is between them. A context manager.

    The namespaces are attributes of their names: ``rover``, ``router``, ``arm``, ``driving``, ``sensor``, ``base``.
    """

    SWITCH = "192.168.77"
    RADIO = "10.98.9"
    ROVER = "10.98.0.2"

    def __init__(self) -> None:
        self._tag = f"rn{os.getpid()}"
        self.router, self.rover, self.base = (f"{self._tag}{name}" for name in ("router", "rover", "base"))
        self.arm, self.driving, self.sensor = (f"{self._tag}{name}" for name in ("arm", "driving", "sensor"))
        self.hosts = Path(f"/etc/netns/{self.rover}/hosts")
        """The rover's own file of host names, which `ip netns exec` puts in the place of /etc/hosts."""

    def __enter__(self) -> RoverNetwork:
        self.hosts.parent.mkdir(parents=True)
        self.hosts.write_text("127.0.0.1 localhost\n")
        for name in (self.router, self.rover, self.base, self.arm, self.driving, self.sensor):
            ip("netns", "add", name)
            ip("-n", name, "link", "set", "lo", "up")
        ip("-n", self.router, "link", "add", "switch", "type", "bridge")
        ip("-n", self.router, "link", "set", "switch", "up")
        ip("-n", self.router, "address", "add", f"{self.SWITCH}.1/24", "dev", "switch")
        for number, board in ((21, self.arm), (22, self.driving), (23, self.sensor)):
            self._cable(board, f"{self.SWITCH}.{number}", f"{self.SWITCH}.1")
            ip("-n", self.router, "link", "set", f"to{board[-6:]}", "master", "switch")
        for end, address in ((self.rover, self.ROVER), (self.base, f"{self.RADIO}.2")):
            router = f"{address.rpartition('.')[0]}.1"
            self._cable(end, address, router)
            ip("-n", self.router, "address", "add", f"{router}/24", "dev", f"to{end[-6:]}")
        inside(self.router, lambda: Path("/proc/sys/net/ipv4/ip_forward").write_text("1"))
        return self

    def _cable(self, end: str, address: str, router: str) -> None:
        port = f"to{end[-6:]}"
        ip("link", "add", "cable", "netns", end, "type", "veth", "peer", "name", port, "netns", self.router)
        ip("-n", end, "address", "add", f"{address}/24", "dev", "cable")
        ip("-n", end, "link", "set", "cable", "up")
        ip("-n", self.router, "link", "set", port, "up")
        ip("-n", end, "route", "add", "default", "via", router)

    def __exit__(self, *_: object) -> None:
        for name in (self.router, self.rover, self.base, self.arm, self.driving, self.sensor):
            ip("netns", "del", name)
        shutil.rmtree(self.hosts.parent)

    def move(self, board: str, number: int, to: int) -> None:
        """Give a board on the switch another address."""
        ip("-n", board, "address", "del", f"{self.SWITCH}.{number}/24", "dev", "cable")
        ip("-n", board, "address", "add", f"{self.SWITCH}.{to}/24", "dev", "cable")
        ip("-n", board, "route", "add", "default", "via", f"{self.SWITCH}.1")


def inside(namespace: str, make: Callable[[], T]) -> T:
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


def impair(namespace: str, device: str, *netem: str) -> str:
    """Let tc(8) spoil what leaves a namespace through a device; why it cannot, or nothing."""
    tc = shutil.which("tc", path=f"{os.environ['PATH']}:/usr/sbin:/sbin")  # not every user's path has it
    if tc is None:
        return "need tc (apt-get install iproute2)"
    command = [tc, "-n", namespace, "qdisc", "replace", "dev", device, "root", "netem", *netem]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return "" if done.returncode == 0 else f"need netem in the kernel: {done.stderr.strip()}"


def _join(namespace: str) -> None:
    """Take the calling thread into a namespace."""
    with Path(f"/run/netns/{namespace}").open() as file:
        libc = ctypes.CDLL(None, use_errno=True)
        if libc.setns(file.fileno(), _CLONE_NEWNET):
            raise OSError(ctypes.get_errno(), f"cannot join {namespace}")
