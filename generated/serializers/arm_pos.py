# Generated from mapping.yaml (row arm_pos) and components/arm_board/movement_software_feedback.proto; do not edit.
# Regenerate with: roverlink generate
"""Fast serialization of ArmBoardActualPositions as comms/msg/ArmBoardActualPositions.

The registry uses this class; programs import `ArmPosHandler`
from `generated.handlers.arm_pos`.
"""

from __future__ import annotations

from generated.handlers.arm_pos import ArmPosHandler
from generated.messages import ArmBoardActualPositions
from generated.pb2.components.arm_board import movement_software_feedback_pb2
from roverlink.runtime.core import cdr

_LAYOUT = cdr.fixed_layout(ArmBoardActualPositions)


class FastArmPosHandler(ArmPosHandler):
    """ArmPosHandler that converts a payload to a serialized ROS message in one step."""

    def _pack(
        self, payload: movement_software_feedback_pb2.ArmBoardActualPositions
    ) -> bytes:
        """Convert a payload to its ROS message, serialized as CDR."""
        return _LAYOUT.pack(
            cdr.LITTLE_ENDIAN,
            payload.jaw_open,
            payload.jaw_actual_position,
            payload.base_actual_position,
            payload.stepper_top_actual_position,
            payload.stepper_bottom_actual_position,
            payload.gripper_rotation_actual_position,
            payload.gripper_pitch_actual_position,
        )
