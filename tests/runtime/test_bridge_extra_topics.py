"""A bridge between a real UDP socket and topics in memory: the rows' further topics, with standard messages."""

from __future__ import annotations

import contextlib
import logging
import math
import socket
import threading
import time
from collections import defaultdict
from collections.abc import Iterator
from typing import Any

import pytest
from polling import wait_until

from generated.registry import REGISTRY
from roverlink.runtime import Bridge, Qos
from roverlink.runtime.core import cdr
from roverlink.runtime.middleware.memory import Graph, MemoryMiddleware
from roverlink.runtime.ros_arguments import parameters

_EXTRA_TOPICS = {handler.route.topic: handler for handler in REGISTRY.extra_topics}


class _Bridged:
    """A bridge, and what it has said on each handler's topic and on imu_data and gps_data."""

    def __init__(self, bridge: Bridge, graph: Graph) -> None:
        self.bridge = bridge
        self._data: defaultdict[str, list[Any]] = defaultdict(list)
        nodes = MemoryMiddleware(graph)
        for handler in REGISTRY.by_topic.values():
            nodes.subscribe(
                f"/{handler.route.topic}", handler.message_type, Qos(), self._data[handler.route.topic].extend
            )

    def on(self, topic: str) -> list[Any]:
        """The messages of a topic, as values."""
        return [cdr.decode(REGISTRY.by_topic[topic].message_type, data) for data in self._data[topic]]

    def send(self, **payloads: Any) -> None:
        """Send a datagram as a board, and wait until it is handled."""
        before = self.bridge.account.received
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as board:
            board.sendto(REGISTRY.envelope(**payloads).SerializeToString(), ("127.0.0.1", self.bridge.port))
        wait_until(lambda: self.bridge.account.received > before, "a datagram")


@pytest.fixture
def bridged() -> Iterator[_Bridged]:
    """A running bridge."""
    values = {"listen_port": 0, "listen_address": "127.0.0.1"}
    with contextlib.ExitStack() as stack:
        graph = Graph()
        bridge = Bridge(
            REGISTRY,
            parameters.read(REGISTRY, values),
            MemoryMiddleware(graph),
            lambda topic: f"/{topic}",
            logging.getLogger("test_bridge_feeds"),
        )
        stack.enter_context(bridge)
        thread = threading.Thread(target=bridge.run, daemon=True)
        thread.start()
        yield _Bridged(bridge, graph)
        bridge.stop()
        thread.join()


def test_a_datagram_feeds_every_topic_of_its_row(bridged: _Bridged) -> None:
    """An IMU's sample is on its own topic and on both of the standard ones, stamped when it was received."""
    before = time.time_ns()
    bridged.send(imu_info={"gyro_z": 90.0, "accel_x": 9.5, "mag_y": 50.0})
    wait_until(lambda: bridged.bridge.account.extra_published["imu/mag"] == 1, "a magnetic field")
    (imu,), (mag,) = bridged.on("imu/data_raw"), bridged.on("imu/mag")
    assert bridged.on("imu_data")[0].gyro_z == 90.0
    assert imu.angular_velocity.z == pytest.approx(math.pi / 2)
    assert imu.linear_acceleration.x == 9.5
    assert mag.magnetic_field.y == pytest.approx(5e-5)
    assert imu.header == mag.header
    assert before <= imu.header.stamp.sec * 10**9 + imu.header.stamp.nanosec <= time.time_ns()
    assert bridged.bridge.account.extra_published == {"imu/data_raw": 1, "imu/mag": 1}


def test_what_does_not_fit_a_feed_is_counted_there(bridged: _Bridged, caplog: pytest.LogCaptureFixture) -> None:
    """The row's own topic has the message; the handler's has not, which is counted and warned of."""
    bridged.send(gps_info={"fix_quality": 9, "latitude": 1.5})
    bridged.send(gps_info={"fix_quality": 1, "latitude": 2.5})
    wait_until(lambda: bridged.bridge.account.extra_published["gps/fix"] == 1, "a fix")
    assert [message.latitude for message in bridged.on("gps_data")] == [1.5, 2.5]
    assert [message.latitude for message in bridged.on("gps/fix")] == [2.5]
    account = bridged.bridge.account.as_dict()
    assert (account["extra_unpublished"], account["extra_published"], account["dropped"]) == (
        {"gps/fix": 1},
        {"gps/fix": 1},
        {},
    )
    assert "not published: gps_info on gps/fix: fix_quality: 9 is not among the values that" in caplog.text


def test_an_extra_topic_without_subscribers_costs_nothing() -> None:
    """A payload is not converted for an extra topic that nobody reads; a subscriber gets every payload that follows."""
    graph = Graph()
    settings = parameters.read(REGISTRY, {"listen_port": 0, "listen_address": "127.0.0.1"})
    middleware = MemoryMiddleware(graph)
    bridge = Bridge(REGISTRY, settings, middleware, lambda topic: f"/{topic}", logging.getLogger("unread"))
    with bridge:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as board:
            misfit = REGISTRY.envelope(gps_info={"fix_quality": 9}).SerializeToString()
            board.sendto(misfit, ("127.0.0.1", bridge.port))
        wait_until(lambda: bridge.account.published["gps_info"] == 1, "a position on the row's own topic")
        late = _Bridged(bridge, graph)
        late.send(gps_info={"fix_quality": 1, "latitude": 2.5})
        wait_until(lambda: bridge.account.extra_published["gps/fix"] == 1, "a fix")
        assert [message.latitude for message in late.on("gps/fix")] == [2.5]
        assert (bridge.account.extra_published, bridge.account.extra_unpublished) == ({"gps/fix": 1}, {})
