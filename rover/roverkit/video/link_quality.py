"""Quality of the link to a computer, as the running bridge publishes it on ``/diagnostics``."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

from roverkit.video.video_declarations import LINK
from roverlink.heard_bridges import HeardBridges
from roverlink.runtime.core.errors import MiddlewareError
from roverlink.runtime.middleware import Middleware


class LinkQuality(NamedTuple):
    """Quality of the link to one computer."""

    loss: float
    """Part of the datagrams to it that were lost recently, from 0 to 1."""
    round_trip: float | None
    """Time in seconds to it and back; None if it is unknown."""


class LinkQualities:
    """Qualities of the links of all bridges that are heard, by the IP address of the other computer."""

    def __init__(self, middleware: Middleware, heard: Callable[[], None], say: Callable[[str], None]) -> None:
        """Listen; `heard` is called, on another thread, after each message of a bridge.

        `say` is called with a message if ROS 2 has no message type for it.
        """
        self._bridges, self._heard = HeardBridges(), heard
        self._by_address: dict[str, LinkQuality] = {}
        self._left: dict[str, float] = {}
        try:
            LINK.subscribe(middleware, lambda name: name, self._take)
        except MiddlewareError as error:
            say(f"the quality of the link is not received: {error}")

    def of(self, address: str) -> LinkQuality | None:
        """Return the quality of the link to an IP address; None if no bridge measures it."""
        return self._by_address.get(address)

    def left_of_budget(self, peer: str) -> float | None:
        """Return the bytes a second that a bridge leaves of a peer's budget; None if no bridge tells a budget."""
        return self._left.get(peer)

    def _take(self, messages: Sequence[bytes]) -> None:
        for message in messages:
            page = self._bridges.take(message)
            if page is None:
                continue
            node = page["node"]
            for peer in (key.removeprefix("budget.") for key in node if key.startswith("budget.")):
                self._left[peer] = max(0.0, node[f"budget.{peer}"] - node.get(f"budget_used.{peer}", 0))
            links = {_end_of(link): link for link in page["links"] if "loss_out" in link}
            for end in page["ends"]:
                if (link := links.get(_end_of(end))) is None:
                    continue
                for address in str(end.get("address", "")).split(", "):
                    host = address.rpartition(":")[0].strip("[]")
                    self._by_address[host] = LinkQuality(link["loss_out"], link.get("round_trip"))
        self._heard()


def _end_of(status: Mapping[str, Any]) -> tuple[str, str]:
    """Return the peer and the board of a status; the board is empty for a peer without boards."""
    return status["peer"], status.get("board", "")
