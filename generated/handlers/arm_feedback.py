# Generated from mapping.yaml (row arm_feedback) and components/arm_board/movement_software_feedback.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row arm_feedback: ArmBoardMovementFeedback and comms/msg/ArmBoardMovementFeedback."""

from __future__ import annotations

from generated.messages import ArmBoardMovementFeedback
from generated.pb2.components.arm_board import movement_software_feedback_pb2
from roverlink.runtime.core.handler import Handler, Route


class ArmFeedbackHandler(
    Handler[
        movement_software_feedback_pb2.ArmBoardMovementFeedback,
        ArmBoardMovementFeedback,
    ]
):
    """Outcome of the last commanded arm movement.

    Number 4 of the envelope, from the peer hardware to the topic arm_feedback.
    """

    route = Route(
        number=4,
        name="arm_feedback",
        topic="arm_feedback",
        direction="hardware_to_ros",
        forward=("basestation",),
        board="ArmBoard",
    )
    payload_type = movement_software_feedback_pb2.ArmBoardMovementFeedback
    message_type = ArmBoardMovementFeedback

    @staticmethod
    def to_ros(
        payload: movement_software_feedback_pb2.ArmBoardMovementFeedback,
    ) -> ArmBoardMovementFeedback:
        """Convert ArmBoardMovementFeedback to comms/msg/ArmBoardMovementFeedback."""
        return ArmBoardMovementFeedback(
            arm_error=payload.arm_error,
        )

    @staticmethod
    def from_ros(
        message: ArmBoardMovementFeedback,
    ) -> movement_software_feedback_pb2.ArmBoardMovementFeedback:
        """Convert comms/msg/ArmBoardMovementFeedback to ArmBoardMovementFeedback."""
        return movement_software_feedback_pb2.ArmBoardMovementFeedback(
            arm_error=message.arm_error,
        )
