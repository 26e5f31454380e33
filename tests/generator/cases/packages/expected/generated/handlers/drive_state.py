# Generated from mapping.yaml (row drive_state) and rover/drive/state.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row drive_state: State and rover/msg/DriveState."""

from __future__ import annotations

from generated.conversions import state_inner
from generated.handlers.arm_state import ArmStateHandler
from generated.messages import DriveState
from generated.pb2.rover.drive import state_pb2
from roverlink.runtime.core.handler import Handler, Route


class DriveStateHandler(Handler[state_pb2.State, DriveState]):
    """State as rover/msg/DriveState.

    Number 2 of the envelope, board_to_ros, topic drive_state.
    """

    route = Route(
        number=2,
        name="drive_state",
        topic="drive_state",
        direction="board_to_ros",
    )
    payload_type = state_pb2.State
    message_type = DriveState

    @staticmethod
    def to_ros(payload: state_pb2.State) -> DriveState:
        """Convert State to rover/msg/DriveState."""
        return DriveState(
            inner=[state_inner.to_ros(item) for item in payload.inner],
            arm=ArmStateHandler.to_ros(payload.arm),
        )

    @staticmethod
    def from_ros(message: DriveState) -> state_pb2.State:
        """Convert rover/msg/DriveState to State."""
        return state_pb2.State(
            inner=[state_inner.from_ros(item) for item in message.inner],
            arm=ArmStateHandler.from_ros(message.arm),
        )
