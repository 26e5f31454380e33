"""The rover's position goes out as whatever message the table has for its row."""

from __future__ import annotations

import dataclasses
import time

import numpy as np

from generated.interfaces.nav_msgs import Odometry
from generated.messages import BasestationRoverLocalization, DrivingBoardMotorMessage
from generated.registry import REGISTRY
from roverlink.runtime import Registry
from roverlink.runtime.core import cdr
from roverlink.runtime.middleware import NodeIdentity, open_middleware
from roverlink.vision.ros.rover_position import FUSED_S, ROW, position_publisher
from tests.polling import wait_until

_POSITION = np.array([1.5, -2.0, 0.25])


def _published(registry: Registry) -> tuple[list[bytes], list[str]]:
    """Publish a position on a middleware in memory; what came on the row's topic, and the warnings."""
    heard: list[bytes] = []
    warnings: list[str] = []
    with open_middleware("memory", NodeIdentity("listener")) as middleware:
        route = REGISTRY.by_name[ROW].route
        middleware.subscribe(f"/{route.topic}", BasestationRoverLocalization, route.qos, heard.extend)
        position_publisher(middleware, registry, lambda name: f"/{name}", warnings.append)(_POSITION)
    return heard, warnings


def test_the_message_type_comes_from_the_row() -> None:
    """Its fields x, y and z are set by name, on the row's topic."""
    (data,), warnings = _published(REGISTRY)
    assert cdr.decode(BasestationRoverLocalization, data) == BasestationRoverLocalization(x=1.5, y=-2.0, z=0.25)
    assert warnings == []


def test_without_the_row_nobody_is_told() -> None:
    """A project may have no such row; there the warning names it, and nothing is published."""
    others = tuple(handler for handler in REGISTRY.handlers if handler.route.name != ROW)
    heard, (warning,) = _published(dataclasses.replace(REGISTRY, handlers=others, extra_topics=()))
    assert heard == []
    assert warning.startswith(f"the rover's position is not sent: the table has no row {ROW!r} ")


def test_a_message_without_the_fields_is_not_published() -> None:
    """The warning names the message, its row, and what it lacks."""

    class Handler(type(REGISTRY.by_name[ROW])):  # type: ignore[misc]  # a class of the registry's
        message_type = DrivingBoardMotorMessage

    heard, (warning,) = _published(dataclasses.replace(REGISTRY, handlers=(Handler(),)))
    assert heard == []
    assert "DrivingBoardMotorMessage, the message of row 'rover_localization', has no field x, y, z;" in warning


def test_a_fused_position_holds_the_one_of_the_markers_back() -> None:
    """Nothing comes on the row's topic after a message on its extra topic, and after a time without one it does."""
    heard: list[bytes] = []
    with open_middleware("memory", NodeIdentity("listener")) as middleware:
        route = REGISTRY.by_name[ROW].route
        middleware.subscribe(f"/{route.topic}", BasestationRoverLocalization, route.qos, heard.extend)
        fused = middleware.publisher("/odometry/global", Odometry, route.qos)
        publish = position_publisher(middleware, REGISTRY, lambda name: f"/{name}")
        fused.publish([cdr.encode(Odometry())])
        start = time.monotonic()
        publish(_POSITION)
        assert heard == []

        def published() -> bool:
            publish(_POSITION)
            return bool(heard)

        wait_until(published, "the position of the markers")
        assert time.monotonic() - start > FUSED_S
