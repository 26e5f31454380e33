"""Values of every row and of every extra topic, between the peers' datagrams and typed messages of rclpy."""

from __future__ import annotations

import time
from collections.abc import Callable
from random import Random
from typing import Any

from judge import Bridge, Heard, Judge, interface, message, repeat
from payloads import random_payload
from polling import wait_until

from generated.registry import REGISTRY
from roverlink.runtime.text.values import message_to_values

Start = Callable[..., Bridge]

_IN_A_ROW = 8  # fewer than a topic's queue holds


def test_every_value_crosses(judge: Judge, bridge: Start) -> None:
    """Random payloads of each inbound row arrive as typed messages with equal values, in order, and none is lost.

    So do the typed messages of each outbound row and its extra topics arrive at the peer. The standard message of each
    inbound extra topic has the values of the payload that feeds it, and the present time.
    """
    inbound = [handler for handler in REGISTRY.handlers if handler.route.inbound]
    heard = [judge.hear(f"/{one.route.topic}", one.message_type.__msgtype__) for one in inbound]
    running = bridge()
    for handler, row in zip(inbound, heard):
        _crosses_to_ros(running, handler, row)
    for handler in (*REGISTRY.handlers, *REGISTRY.extra_topics):
        if not handler.route.inbound:
            _crosses_to_peer(judge, running, handler)
    for topic in REGISTRY.extra_topics:
        if topic.route.inbound:
            _feeds(judge, running, topic)


def test_stamps_are_times_of_the_simulation(judge: Judge, bridge: Start) -> None:
    """With `use_sim_time`, the stamps of messages and of the diagnostics are those of /clock."""
    clock = judge.node.create_publisher(interface("rosgraph_msgs/msg/Clock"), "/clock", 10)
    now = {"sec": 1000, "nanosec": 5}
    running = bridge("-p", "use_sim_time:=true")

    def tick() -> None:
        clock.publish(message("rosgraph_msgs/msg/Clock", {"clock": now}))
        running.send(imu_info={"accel_x": 1.0})

    for topic, type_name in (
        ("/imu/data_raw", "sensor_msgs/msg/Imu"),
        ("/diagnostics", "diagnostic_msgs/msg/DiagnosticArray"),
    ):
        heard = judge.hear(topic, type_name)
        repeat(tick, lambda heard=heard: now in [one["header"]["stamp"] for one in heard.values], f"{now} on {topic}")


def _crosses_to_ros(running: Bridge, handler: Any, heard: Heard) -> None:
    name = handler.route.name
    first, *others = _payloads(handler)
    wanted = [message_to_values(handler.to_ros(payload)) for payload in others]
    repeat(lambda: running.send(**{name: first}), lambda: heard.values, f"a first {name}")
    for payload in others:
        running.send(**{name: payload})
    wait_until(lambda: heard.values[-len(wanted) :] == wanted, f"{wanted} on {heard.topic}")


def _crosses_to_peer(judge: Judge, running: Bridge, handler: Any) -> None:
    topic, type_name = f"/{handler.route.topic}", handler.message_type.__msgtype__
    said = [message_to_values(handler.to_ros(payload)) for payload in _payloads(handler)]
    first, *others = [message(type_name, values) for values in said]
    publisher = judge.node.create_publisher(type(first), topic, 10)
    arrived = _Arrived(running, handler)
    repeat(lambda: publisher.publish(first), lambda: said[0] in arrived.values(), f"a first {topic}")
    for other in others:
        publisher.publish(other)
    wait_until(lambda: arrived.values()[-len(others) :] == said[1:], f"{said[1:]} of {topic} at the peer")


def _payloads(handler: Any) -> list[Any]:
    random = Random(handler.route.number)  # noqa: S311  # repeatable, not secret
    return [random_payload(handler.payload_type, random) for _ in range(1 + _IN_A_ROW)]


class _Arrived:
    """What has arrived at the peer of a row, without the stops that it gets while its topic is silent."""

    def __init__(self, running: Bridge, handler: Any) -> None:
        self._running, self._handler = running, handler
        self._values: list[dict[str, Any]] = []

    def values(self) -> list[dict[str, Any]]:
        route, payload_type = self._handler.route, self._handler.payload_type
        for envelope in self._running.arrived(route.peer):
            payload = getattr(envelope, route.name)
            is_stop = route.deadman and payload == payload_type()
            if envelope.WhichOneof(REGISTRY.oneof) == route.name and not is_stop:
                self._values.append(message_to_values(self._handler.to_ros(payload)))
        return self._values


def _feeds(judge: Judge, running: Bridge, topic: Any) -> None:
    heard = judge.hear(f"/{topic.route.topic}", topic.message_type.__msgtype__)
    payload = _payloads(topic)[0]
    repeat(lambda: running.send(**{topic.route.name: payload}), lambda: heard.values, topic.route.topic)
    wanted, got = message_to_values(topic.to_ros(payload)), heard.values[0]
    stamp = got["header"].pop("stamp")
    del wanted["header"]["stamp"]
    assert got == wanted
    assert abs(stamp["sec"] - time.time()) < 60
