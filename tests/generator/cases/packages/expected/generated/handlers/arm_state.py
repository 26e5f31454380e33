# Generated from mapping.yaml (row arm_state) and rover/arm/state.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row arm_state: State and rover/msg/ArmState."""

from __future__ import annotations

from generated.conversions import common
from generated.handlers.inner import InnerHandler
from generated.handlers.top import TopHandler
from generated.messages import ArmKind, ArmState
from generated.pb2.rover.arm import state_pb2
from roverlink.runtime.core.handler import Handler, Route


class ArmStateHandler(Handler[state_pb2.State, ArmState]):
    """State as rover/msg/ArmState.

    Number 1 of the envelope, board_to_ros, topic arm_state.
    """

    route = Route(
        number=1,
        name="arm_state",
        topic="arm_state",
        direction="board_to_ros",
    )
    payload_type = state_pb2.State
    message_type = ArmState

    @staticmethod
    def to_ros(payload: state_pb2.State) -> ArmState:
        """Convert State to rover/msg/ArmState."""
        return ArmState(
            inner=InnerHandler.to_ros(payload.inner),
            common=common.to_ros(payload.common),
            top=TopHandler.to_ros(payload.top),
            kind=ArmKind(kind=payload.kind),
        )

    @staticmethod
    def from_ros(message: ArmState) -> state_pb2.State:
        """Convert rover/msg/ArmState to State."""
        return state_pb2.State(
            inner=InnerHandler.from_ros(message.inner),
            common=common.from_ros(message.common),
            top=TopHandler.from_ros(message.top),
            kind=message.kind.kind,
        )
