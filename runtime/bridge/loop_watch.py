"""Search for the rover's bridge in the ROS 2 graph of a bridge that is the other end of its link (``run --as``).

If both bridges had a topic in common, each message of the peer would go round for ever: to the rover by UDP, there to
its topic, and back by ROS 2. The rover would obey an old command, and no deadman would notice.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.middleware import Endpoint

_LOOK_S = 2.0


class LoopWatch:
    """Timed task that looks every two seconds for a bridge that publishes a topic which this one sends to the rover."""

    def __init__(self, topics: Iterable[str], endpoints: Callable[[str, bool], Sequence[Endpoint]], name: str) -> None:
        """Create the task; ``topics`` have full names, and ``name`` is the name of the nodes of bridges."""
        self._topics, self._endpoints, self._name = tuple(topics), endpoints, name
        self.next_due = 0.0

    def run_due(self, now: float) -> None:
        """Look for another bridge if two seconds have passed. Raises `SetupError` if there is one."""
        if now < self.next_due:
            return
        self.next_due = now + _LOOK_S
        for topic in self._topics:
            for publisher in self._endpoints(topic, True):
                if publisher.node.rpartition("/")[2] == self._name:
                    raise SetupError(
                        f"the bridge {publisher.node} publishes {topic}, which this bridge sends to the rover; if that "
                        "is the rover's bridge, commands would go round for ever: give this computer another "
                        f"ROS_DOMAIN_ID. If not, rename that node, such as -r __node:=other_{self._name}"
                    )
