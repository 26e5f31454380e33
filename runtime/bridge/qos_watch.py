"""Search for publishers and subscriptions of other nodes whose QoS does not match the bridge's.

DDS passes no messages between a publisher and a subscription whose QoS does not match, and neither node gets an error.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence

from roverlink.runtime.bridge.account import Account, ThrottledWarnings
from roverlink.runtime.core.handler import Qos, Route
from roverlink.runtime.middleware import Endpoint

_LOOK_S = 2.0
# Values of a policy that a subscription may require; a publisher with the policy's other value does not match it.
_REQUIREMENTS = {"reliability": "reliable", "durability": "transient_local"}

Endpoints = Callable[[str, bool], Sequence[Endpoint]]
"""Function that returns the publishers (true) or the subscriptions (false) of a fully qualified topic."""


class QosWatch:
    """Timed task that looks every two seconds for nodes whose QoS does not match the bridge's.

    It logs a warning for each new mismatch. A mismatch counts if two looks in a row find it, because DDS often finds an
    endpoint before the name of its node.
    """

    def __init__(
        self, routes: Mapping[str, Route], endpoints: Endpoints, account: Account, warnings: ThrottledWarnings
    ) -> None:
        """Create the task; ``routes`` has the routes of all topics by the topic's fully qualified name."""
        self._routes, self._endpoints = routes, endpoints
        self._account, self._warnings = account, warnings
        self._seen: set[tuple[str, str]] = set()  # topics with texts, of the last look
        self._confirmed: set[tuple[str, str]] = set()
        self.next_due = 0.0

    def run_due(self, now: float) -> None:
        """Look for QoS mismatches if two seconds have passed, count them, and log a warning for each new one."""
        if now < self.next_due:
            return
        self.next_due = now + _LOOK_S
        seen = {(topic, text) for topic, route in self._routes.items() for text in self._mismatches(topic, route)}
        before, self._confirmed = self._confirmed, seen & self._seen
        self._seen = seen
        for topic, text in sorted(self._confirmed - before):
            self._warnings.warn(f"QoS {topic} {text}", f"{topic}: {text}; change the QoS of one side")
        mismatches: dict[str, list[str]] = {}
        for topic, text in sorted(self._confirmed):
            mismatches.setdefault(self._routes[topic].topic, []).append(text)
        self._account.qos_mismatches = mismatches

    def _mismatches(self, topic: str, route: Route) -> Iterator[str]:
        for endpoint in self._endpoints(topic, not route.inbound):
            node = endpoint.node or "an unknown node"
            if route.inbound and (policy := unsatisfied(route.qos, endpoint.qos, endpoint.demands)):
                yield f"a subscription of {node} gets no messages ({policy})"
            elif not route.inbound and (policy := unsatisfied(endpoint.qos, route.qos)):
                yield f"no messages come from a publisher of {node} ({policy})"


def unsatisfied(offered: Qos, requested: Qos, demands: Sequence[str] = ()) -> str:
    """Return the first policy in which a publisher does not satisfy a subscription; an empty text if there is none.

    The text is ``reliability: reliable required, best_effort offered``, for example. ``demands`` names further policies
    that the subscription requires and the publisher does not offer.
    """
    for policy, strict in _REQUIREMENTS.items():
        if getattr(requested, policy) == strict != (value := getattr(offered, policy)):
            return f"{policy}: {strict} required, {value} offered"
    return next((f"{policy}: required, not offered" for policy in demands), "")
