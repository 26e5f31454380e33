"""Parts that other packages add to ``roverlink demo``, such as a rover that drives."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

from roverlink.runtime import Registry
from roverlink.runtime.client import BlockingPeer, Received
from roverlink.runtime.middleware import Middleware

ENTRY_POINTS = "roverlink.demo"
"""Group of entry points; each is a function `OpenParts`."""
STEP_NS = 10_000_000
"""Simulated time between two steps, in nanoseconds."""


@dataclass(frozen=True, slots=True)
class DemoSetting:
    """What the parts of a demo may need to know before they start."""

    project: Path
    registry: Registry
    middleware: str
    """``memory`` if the topics exist only in this process, else the middleware that connects with ROS 2."""
    folder: Path
    """Empty folder for files, which is removed at the end of the demo."""
    say: Callable[[str], None]
    """Function that shows the user a line, for example about a package that is not installed."""


class DemoPart:
    """Part of a demo that sends messages of its own, or shows something. Its methods do nothing if it needs none."""

    rows: Collection[str] = ()
    """Names of the rows whose messages the part sends; the demo sends no example values for them."""

    def join(self, middleware: Middleware) -> None:
        """Create publishers and subscribers in the demo's node."""

    def step(self, peers: Mapping[str, BlockingPeer]) -> None:
        """Advance the simulated time by `STEP_NS`; ``peers`` are the programs in place of the peers."""

    def receive(self, peer: str, received: Received) -> None:
        """Take a payload that the bridge has sent to a peer."""

    def stop(self) -> str:
        """End, and return a line for the user about what the part did."""
        raise NotImplementedError


OpenParts = Callable[[DemoSetting, ExitStack], Iterable[DemoPart]]
"""Function that starts the parts of a package; the stack of contexts closes them."""
