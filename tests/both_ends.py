"""Two bridges with a bad link between them: the rover's in the namespace /rover, and that of a peer in /base."""

from __future__ import annotations

import contextlib
import logging
import shutil
import socket
from collections.abc import Callable, Sequence
from datetime import datetime, timezone
from functools import partial
from pathlib import Path
from typing import Any

from polling import wait_until
from relay import Relay

from roverlink.runtime import Bridge, Registry
from roverlink.runtime.bridge.signed_peers import open_links
from roverlink.runtime.core.mirror import ROVER, mirrored
from roverlink.runtime.core.registry import EndName
from roverlink.runtime.keys.key_file import make_key_file
from roverlink.runtime.keys.signed_links import SignedLinks
from roverlink.runtime.ros_arguments import parameters

LOGGER = logging.getLogger("both_ends")
BASE = EndName("basestation")


class BothEnds:
    """Two bridges, each over a middleware that a function makes for its namespace. A context manager."""

    def __init__(
        self,
        registry: Registry,
        middleware: Callable[[str], Any],
        end: EndName = BASE,
        of_base: Registry | None = None,
        links: Callable[[Registry], SignedLinks | None] = lambda _: None,
        loss: float = 0.0,
        direct: bool = False,
        topic: str = "/{namespace}/{}",
        **given: Any,
    ) -> None:
        self.base_end, self.registry, self.mirror = end, registry, mirrored(of_base or registry, end, 5000)
        self._held, self._topic = contextlib.ExitStack(), topic
        to_base, to_rover = (self._held.enter_context(_bound()) for _ in range(2))
        to_peer = {} if direct else {registry.ends[end].port_parameter: _port(to_base)}
        self.rover = self._bridge(registry, middleware, "rover", links, {**to_peer, **given})
        port = self.rover.port if direct else _port(to_rover)
        self.base = self._bridge(self.mirror, middleware, "base", links, {"rover_port": port, **given})
        bad = {"loss": loss, "twice": 0.0, "delay_s": 0.002}
        self.to_base = Relay(to_base, ("127.0.0.1", self.base.port), 1, **bad)
        self.to_rover = Relay(to_rover, ("127.0.0.1", self.rover.port), 2, **bad)
        self.bridges: Sequence[Bridge] = (self.rover, self.base)

    def _bridge(self, registry: Registry, middleware: Any, name: str, links: Any, given: dict[str, Any]) -> Bridge:
        settings = parameters.read(registry, {"listen_port": 0, "listen_address": "127.0.0.1", **given})
        if keys := links(registry):
            self._held.enter_context(keys)
        return Bridge(
            registry, settings, middleware(name), partial(self._topic.format, namespace=name), LOGGER, links=keys
        )

    def settle(self) -> None:
        """Wait until all that one bridge has sent has come to the other, or is lost."""
        ways = (
            (self.rover, self.registry, self.base_end.peer, self.to_base, self.base),
            (self.base, self.mirror, ROVER, self.to_rover, self.rover),
        )
        wait_until(lambda: all(_is_through(*way) for way in ways), "what is on its way")

    def __enter__(self) -> BothEnds:
        for one in (*self.bridges, self.to_base, self.to_rover):
            self._held.enter_context(one)
        return self

    def __exit__(self, *_: object) -> None:
        for bridge in self.bridges:
            bridge.stop()
        self._held.close()
        assert [bridge.account.discrepancies() for bridge in self.bridges] == [[], []]


def _is_through(near: Bridge, registry: Registry, peer: str, link: Relay, far: Bridge) -> bool:
    account = near.account
    own = sum(count for row, count in account.sent.items() if registry.by_name[row].route.peer == peer)
    sent = own + account.forwarded[peer] + account.links_sent[peer]
    return link.has_taken(sent) and has_handled(far, link.handed_on)


def has_handled(bridge: Bridge, datagrams: int) -> bool:
    """True if a bridge has received so many datagrams, and has counted what became of them."""
    account = bridge.account
    return account.received >= datagrams and not account.discrepancies()


def copied_keys(folder: Path, end: str) -> Callable[[Registry], SignedLinks | None]:
    """Make the key file of a link with a copy for its other end, and return what opens the one of a registry."""
    files = [folder / where / f"{end}.keys" for where in ("rover", "base")]
    for file in files:
        file.parent.mkdir()
    make_key_file(files[0], end, datetime.now(timezone.utc))
    shutil.copy(*files)
    return lambda one: open_links(one, [files[one.own is not None]] if one.signature else [], LOGGER)


def _bound() -> socket.socket:
    sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sock.bind(("127.0.0.1", 0))
    return sock


def _port(sock: socket.socket) -> int:
    return int(sock.getsockname()[1])
