# Generated from mapping.yaml (row cart) and wheel.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row cart: Cart and rover/msg/Cart."""

from __future__ import annotations

from generated.handlers.left import LeftHandler
from generated.messages import Cart
from generated.pb2 import wheel_pb2
from roverlink.runtime.core.handler import Handler, Route


class CartHandler(Handler[wheel_pb2.Cart, Cart]):
    """Cart as rover/msg/Cart.

    Number 3 of the envelope, board_to_ros, topic cart.
    """

    route = Route(
        number=3,
        name="cart",
        topic="cart",
        direction="board_to_ros",
    )
    payload_type = wheel_pb2.Cart
    message_type = Cart

    @staticmethod
    def to_ros(payload: wheel_pb2.Cart) -> Cart:
        """Convert Cart to rover/msg/Cart."""
        return Cart(
            wheels=[LeftHandler.to_ros(item) for item in payload.wheels],
        )

    @staticmethod
    def from_ros(message: Cart) -> wheel_pb2.Cart:
        """Convert rover/msg/Cart to Cart."""
        return wheel_pb2.Cart(
            wheels=[LeftHandler.from_ros(item) for item in message.wheels],
        )
