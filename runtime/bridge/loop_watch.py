"""Search for the rover's bridge in the ROS 2 graph of a bridge that is the other end of its link (``run --as``).

If both bridges had the same topics, each message of the peer would go round for ever: to the rover by UDP, there to its
topic, and back by ROS 2. The rover would obey an old command, and no deadman would notice.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.core.handler import Route
from roverlink.runtime.middleware import Endpoint

_LOOK_S = 2.0


class LoopWatch:
    """Timed task that looks every two seconds for the rover's bridge: it publishes all topics that we take.

    It also publishes or takes all topics that we publish, and its node has the bridge's name. So it is no other node,
    such as a player of recordings.
    """

    def __init__(
        self, routes: Mapping[str, Route], endpoints: Callable[[str, bool], Sequence[Endpoint]], name: str
    ) -> None:
        """Create the task; ``routes`` has the routes of all topics by the topic's full name, ``name`` is the node's."""
        self._routes, self._endpoints, self._name = routes, endpoints, name
        self.next_due = 0.0

    def run_due(self, now: float) -> None:
        """Look for the rover's bridge if two seconds have passed. Raises `SetupError` if it is there."""
        if now < self.next_due:
            return
        self.next_due = now + _LOOK_S
        found: set[str] | None = None
        for topic, route in self._routes.items():
            sides = (True, False) if route.inbound else (True,)
            nodes = {one.node for side in sides for one in self._endpoints(topic, side)}
            found = nodes if found is None else found & nodes
        for node in found or ():
            if node.rpartition("/")[2] == self._name:
                raise SetupError(
                    f"the rover's bridge, {node}, has the same topics as this one, so that commands would go round for "
                    "ever; give this computer another ROS_DOMAIN_ID, or one of the bridges a namespace (-r __ns:=/base)"
                )
