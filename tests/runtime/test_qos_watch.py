"""Publishers and subscriptions of other nodes whose QoS does not match the bridge's."""

from __future__ import annotations

import logging
from collections.abc import Sequence

import pytest

from roverlink.runtime import Qos
from roverlink.runtime.bridge.account import Account, ThrottledWarnings
from roverlink.runtime.bridge.qos_watch import QosWatch
from roverlink.runtime.core.handler import Route
from roverlink.runtime.middleware import Endpoint

_ROUTES = {
    "/imu_data": Route(1, "imu", "imu_data", "hardware_to_ros"),
    "/drive_motor": Route(2, "drive", "drive_motor", "ros_to_hardware"),
}
_BEST_EFFORT = Qos(reliability="best_effort")
_LATCHED = Qos(durability="transient_local")


class _Watch:
    """A watch of a row in each direction, over a graph that the test changes."""

    def __init__(self) -> None:
        self.graph: dict[tuple[str, bool], Sequence[Endpoint]] = {}
        self.account = Account()
        warnings = ThrottledWarnings(logging.getLogger("qos"))
        self._watch = QosWatch(_ROUTES, self._endpoints, self.account, warnings)

    def _endpoints(self, topic: str, publishing: bool) -> Sequence[Endpoint]:
        return self.graph.get((topic, publishing), ())

    def look(self, times: int = 1) -> None:
        for _ in range(times):
            self._watch.run_due(self._watch.next_due)


@pytest.fixture
def watch() -> _Watch:
    """A watch over an empty graph."""
    return _Watch()


_UNHEARD = "a subscription of {} gets no messages (durability: transient_local required, volatile offered)"
_MISMATCHES: list[tuple[str, Endpoint, str]] = [
    ("imu_data", Endpoint("/viz", _LATCHED), _UNHEARD.format("/viz")),
    ("imu_data", Endpoint("", _LATCHED), _UNHEARD.format("an unknown node")),
    (
        "imu_data",
        Endpoint("/viz", Qos(), ("deadline",)),
        "a subscription of /viz gets no messages (deadline: required, not offered)",
    ),
    (
        "drive_motor",
        Endpoint("/joystick", _BEST_EFFORT),
        "no messages come from a publisher of /joystick (reliability: reliable required, best_effort offered)",
    ),
]


@pytest.mark.parametrize(("topic", "endpoint", "text"), _MISMATCHES)
def test_an_endpoint_that_cannot_match(
    watch: _Watch, topic: str, endpoint: Endpoint, text: str, caplog: pytest.LogCaptureFixture
) -> None:
    """It is counted by the row's topic, and warned of once, with its node and the policy, until it has left."""
    watch.graph[f"/{topic}", topic == "drive_motor"] = [endpoint]
    watch.look(times=4)
    assert watch.account.qos_mismatches == {topic: [text]}
    assert caplog.messages == [f"/{topic}: {text}; change the QoS of one side"]
    watch.graph.clear()
    watch.look()
    assert watch.account.qos_mismatches == {}


def test_endpoints_that_match(watch: _Watch, caplog: pytest.LogCaptureFixture) -> None:
    """A weaker subscription and a stronger publisher match, and so do endpoints of the bridge's own side."""
    watch.graph = {
        ("/imu_data", False): [Endpoint("/viz", _BEST_EFFORT), Endpoint("/log", Qos())],
        ("/imu_data", True): [Endpoint("/other", _BEST_EFFORT)],
        ("/drive_motor", True): [Endpoint("/joystick", _LATCHED)],
        ("/drive_motor", False): [Endpoint("/other", _LATCHED)],
    }
    watch.look(times=2)
    assert (watch.account.qos_mismatches, caplog.messages) == ({}, [])


def test_the_name_of_a_node_may_come_later(watch: _Watch, caplog: pytest.LogCaptureFixture) -> None:
    """A mismatch that one look alone has seen is not told: the next look may know the node."""
    watch.graph["/drive_motor", True] = [Endpoint("", _BEST_EFFORT)]
    watch.look()
    watch.graph["/drive_motor", True] = [Endpoint("/joystick", _BEST_EFFORT)]
    watch.look(times=2)
    assert len(caplog.messages) == 1
    assert "/joystick" in caplog.text
