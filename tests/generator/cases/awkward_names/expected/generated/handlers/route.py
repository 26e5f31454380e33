# Generated from mapping.yaml (row route) and awkward.proto; do not edit.
# Regenerate with: roverlink generate
"""route (3): Route from rover/msg/Route on route."""

from __future__ import annotations

from generated.conversions import route_handler, route_qos, waypoint
from generated.messages import Route_
from generated.pb2 import awkward_pb2
from roverlink.runtime.core.handler import Handler, Qos, Route


class RouteHandler(Handler[awkward_pb2.Route, Route_]):
    """Route from the topic route."""

    route = Route(
        number=3,
        name="route",
        topic="route",
        direction="ros_to_board",
        qos=Qos(depth=3),
    )
    payload_type = awkward_pb2.Route
    message_type = Route_

    @staticmethod
    def to_ros(payload: awkward_pb2.Route) -> Route_:
        """The message that says what the payload says."""
        return Route_(
            handler=route_handler.to_ros(payload.handler),
            qos=route_qos.to_ros(payload.qos),
            waypoints=[waypoint.to_ros(item) for item in payload.waypoints],
        )

    @staticmethod
    def from_ros(message: Route_) -> awkward_pb2.Route:
        """The payload that says what the message says."""
        return awkward_pb2.Route(
            handler=route_handler.from_ros(message.handler),
            qos=route_qos.from_ros(message.qos),
            waypoints=[waypoint.from_ros(item) for item in message.waypoints],
        )
