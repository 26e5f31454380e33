# Generated from mapping.yaml (row arm_feedback) and components/arm_board/movement_software_feedback.proto; do not edit.
# Regenerate with: roverlink generate
"""arm_feedback (4): ArmBoardMovementFeedback to comms/msg/ArmBoardMovementFeedback on arm_feedback."""

from __future__ import annotations

from generated.messages import ArmBoardMovementFeedback
from generated.pb2.components.arm_board import movement_software_feedback_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Handler, Route

_CDR = cdr.fixed_layout(ArmBoardMovementFeedback)


class ArmFeedbackHandler(
    Handler[
        movement_software_feedback_pb2.ArmBoardMovementFeedback,
        ArmBoardMovementFeedback,
    ],
):
    """ArmBoardMovementFeedback to the topic arm_feedback."""

    route = Route(
        number=4,
        name="arm_feedback",
        topic="arm_feedback",
        direction="hardware_to_ros",
        forward=("basestation",),
    )
    payload_type = movement_software_feedback_pb2.ArmBoardMovementFeedback
    message_type = ArmBoardMovementFeedback

    @staticmethod
    def to_ros(
        payload: movement_software_feedback_pb2.ArmBoardMovementFeedback,
    ) -> ArmBoardMovementFeedback:
        """The message that says what the payload says."""
        return ArmBoardMovementFeedback(arm_error=payload.arm_error)

    @staticmethod
    def from_ros(
        message: ArmBoardMovementFeedback,
    ) -> movement_software_feedback_pb2.ArmBoardMovementFeedback:
        """The payload that says what the message says."""
        return movement_software_feedback_pb2.ArmBoardMovementFeedback(
            arm_error=message.arm_error,
        )

    def pack(
        self,
        payload: movement_software_feedback_pb2.ArmBoardMovementFeedback,
    ) -> bytes:
        """`to_ros` and its serialization in one step: the values in the order of the .msg."""
        return _CDR.pack(cdr.LITTLE_ENDIAN, payload.arm_error)
