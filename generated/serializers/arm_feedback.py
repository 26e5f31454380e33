# Generated from mapping.yaml (row arm_feedback) and components/arm_board/movement_software_feedback.proto; do not edit.
# Regenerate with: roverlink generate
"""Fast serialization of ArmBoardMovementFeedback as comms/msg/ArmBoardMovementFeedback.

The registry uses this class; programs import `ArmFeedbackHandler`
from `generated.handlers.arm_feedback`.
"""

from __future__ import annotations

from generated.handlers.arm_feedback import ArmFeedbackHandler
from generated.messages import ArmBoardMovementFeedback
from generated.pb2.components.arm_board import movement_software_feedback_pb2
from roverlink.runtime.core import cdr

_LAYOUT = cdr.fixed_layout(ArmBoardMovementFeedback)


class FastArmFeedbackHandler(ArmFeedbackHandler):
    """ArmFeedbackHandler that converts a payload to a serialized ROS message in one step."""

    def _pack(
        self, payload: movement_software_feedback_pb2.ArmBoardMovementFeedback
    ) -> bytes:
        """Convert a payload to its ROS message, serialized as CDR."""
        return _LAYOUT.pack(
            cdr.LITTLE_ENDIAN,
            payload.arm_error,
        )
