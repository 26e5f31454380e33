"""Network namespaces: a rover and a board with a cable that can be cut, and the network of a whole rover.

A thread joins a namespace with setns(2), and the sockets that it makes there stay there, as do the programs that it
starts: so a whole bridge runs in the tests' own process. Needs root.
"""

from __future__ import annotations

import ctypes
import os
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager, suppress
from functools import partial
from pathlib import Path
from typing import TypeVar

from polling import wait_until

T = TypeVar("T")

ROVER, BOARD = "10.99.0.1", "10.99.0.2"
_CLONE_NEWNS, _CLONE_NEWNET = 0x00020000, 0x40000000
_MS_BIND, _MS_REC, _MS_PRIVATE = 0x1000, 0x4000, 0x40000
_LIBC = ctypes.CDLL(None, use_errno=True)


def why_not() -> str:
    """Why there can be no namespaces here; empty where there can."""
    if sys.platform != "linux" or os.geteuid() != 0:
        return "need network namespaces (Linux, as root)"
    try:
        made = subprocess.run(["unshare", "-n", "ip", "link", "show", "lo"], capture_output=True, check=False)
    except OSError as error:
        return f"need network namespaces ({error})"
    return "" if made.returncode == 0 else f"need network namespaces ({made.stderr.decode().strip()})"


def ip(*arguments: str) -> str:
    """Change or show the network; raises where that fails."""
    return subprocess.run(["ip", *arguments], check=True, capture_output=True, text=True).stdout


def inside(namespace: str, make: Callable[[], T], hosts: Path | None = None) -> T:
    """What a function makes in a namespace; ``hosts`` is put in the place of /etc/hosts."""

    def run() -> T:
        with Path(f"/run/netns/{namespace}").open() as file:
            _check(_LIBC.setns(file.fileno(), _CLONE_NEWNET))
        if hosts:
            _check(_LIBC.unshare(_CLONE_NEWNS))
            _check(_LIBC.mount(b"none", b"/", None, _MS_REC | _MS_PRIVATE, None))
            _check(_LIBC.mount(bytes(hosts), b"/etc/hosts", None, _MS_BIND, None))
        return make()

    with ThreadPoolExecutor(1) as thread:  # a thread of its own, which ends in the namespace
        return thread.submit(run).result()


def bound(address: tuple[str, int]) -> socket.socket:
    """A socket with room for many datagrams, which waits for none."""
    sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4 * 1024 * 1024)
    sock.bind(address)
    sock.setblocking(False)
    return sock


def arrived(sock: socket.socket) -> Iterator[bytes]:
    """The datagrams that have arrived at a socket since the last call."""
    with suppress(BlockingIOError):
        while True:
            yield sock.recv(65_536)


def _check(result: int) -> None:
    if result:
        raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))


@contextmanager
def _namespaces(*names: str) -> Iterator[list[str]]:
    """Namespaces of this process, each with its own loopback."""
    with ExitStack() as held:
        made = [f"rl{os.getpid()}{name}" for name in names]
        for name in made:
            ip("netns", "add", name)
            held.callback(ip, "netns", "del", name)
            ip("-n", name, "link", "set", "lo", "up")
        yield made


def _connect(end: str, address: str, other: str, port: str) -> None:
    """Lay a cable from a namespace, where it is called ``cable`` and has the address, to a port of another one."""
    ip("link", "add", "cable", "netns", end, "type", "veth", "peer", "name", port, "netns", other)
    ip("-n", end, "address", "add", f"{address}/24", "dev", "cable")
    ip("-n", end, "link", "set", "cable", "up")
    ip("-n", other, "link", "set", port, "up")
    for space, device in ((end, "cable"), (other, port)):  # until the kernel has seen that it is there, it drops frames
        wait_until(partial(_shows, "state UP", space, device), "the cable")


def _shows(text: str, space: str, device: str) -> bool:
    return text in ip("-n", space, "-details", "link", "show", device)


class Network(ExitStack):
    """A rover and a board, each with its end of a cable. A context manager."""

    def __enter__(self) -> Network:
        self.rover, self.board = self.enter_context(_namespaces("rover", "board"))
        _connect(self.rover, ROVER, self.board, "cable")
        ip("-n", self.board, "address", "add", f"{BOARD}/24", "dev", "cable")
        return self


class RoverNetwork(ExitStack):
    """A rover, three boards on a switch, and a basestation behind a radio; a router is between them."""

    SWITCH = "192.168.77"
    RADIO = "10.98.9"
    ROVER = "10.98.0.2"

    def __enter__(self) -> RoverNetwork:
        names = ("router", "rover", "base", "arm", "driving", "sensor")
        spaces = self.enter_context(_namespaces(*names))
        self.router, self.rover, self.base, self.arm, self.driving, self.sensor = spaces
        ip("-n", self.router, "link", "add", "switch", "type", "bridge")
        ip("-n", self.router, "link", "set", "switch", "up")
        ip("-n", self.router, "address", "add", f"{self.SWITCH}.1/24", "dev", "switch")
        for number, board in ((21, self.arm), (22, self.driving), (23, self.sensor)):
            _connect(board, f"{self.SWITCH}.{number}", self.router, f"to{number}")
            ip("-n", self.router, "link", "set", f"to{number}", "master", "switch")
            ip("-n", board, "route", "add", "default", "via", f"{self.SWITCH}.1")
        for port, end, address in (("torover", self.rover, self.ROVER), ("tobase", self.base, f"{self.RADIO}.2")):
            router = f"{address.rpartition('.')[0]}.1"
            _connect(end, address, self.router, port)
            ip("-n", self.router, "address", "add", f"{router}/24", "dev", port)
            ip("-n", end, "route", "add", "default", "via", router)
        inside(self.router, lambda: Path("/proc/sys/net/ipv4/ip_forward").write_text("1"))
        for number in (21, 22, 23):
            wait_until(partial(_shows, "state forwarding", self.router, f"to{number}"), "a switch that passes frames")
        return self

    def move(self, board: str, number: int, to: int) -> None:
        """Give a board on the switch another address."""
        ip("-n", board, "address", "del", f"{self.SWITCH}.{number}/24", "dev", "cable")
        ip("-n", board, "address", "add", f"{self.SWITCH}.{to}/24", "dev", "cable")
        ip("-n", board, "route", "add", "default", "via", f"{self.SWITCH}.1")
