# Generated from mapping.yaml (row route) and awkward.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row route: Route and rover/msg/Route."""

from __future__ import annotations

from generated.conversions import route_handler, route_qos, waypoint
from generated.messages import Route_
from generated.pb2 import awkward_pb2
from roverlink.runtime.core.handler import Handler, Qos, Route


class RouteHandler(Handler[awkward_pb2.Route, Route_]):
    """Route as rover/msg/Route.

    Number 3 of the envelope, ros_to_board, topic route.
    """

    route = Route(
        number=3,
        name="route",
        topic="route",
        direction="ros_to_board",
        qos=Qos(
            depth=3,
        ),
    )
    payload_type = awkward_pb2.Route
    message_type = Route_

    @staticmethod
    def to_ros(payload: awkward_pb2.Route) -> Route_:
        """Convert Route to rover/msg/Route."""
        return Route_(
            handler=route_handler.to_ros(payload.handler),
            qos=route_qos.to_ros(payload.qos),
            waypoints=[waypoint.to_ros(item) for item in payload.waypoints],
        )

    @staticmethod
    def from_ros(message: Route_) -> awkward_pb2.Route:
        """Convert rover/msg/Route to Route."""
        return awkward_pb2.Route(
            handler=route_handler.from_ros(message.handler),
            qos=route_qos.from_ros(message.qos),
            waypoints=[waypoint.from_ros(item) for item in message.waypoints],
        )
