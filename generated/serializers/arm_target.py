# Generated from mapping.yaml (row arm_target) and components/arm_board/movement_software_target.proto; do not edit.
# Regenerate with: roverlink generate
"""Fast serialization of ArmBoardTargetMovement as comms/msg/ArmBoardTargetMovement.

The registry uses this class; programs import `ArmTargetHandler`
from `generated.handlers.arm_target`.
"""

from __future__ import annotations

from generated.handlers.arm_target import ArmTargetHandler
from generated.messages import ArmBoardTargetMovement
from generated.pb2.components.arm_board import movement_software_target_pb2
from roverlink.runtime.core import cdr

_LAYOUT = cdr.fixed_layout(ArmBoardTargetMovement)


class FastArmTargetHandler(ArmTargetHandler):
    """ArmTargetHandler that converts a payload to a serialized ROS message in one step."""

    def _pack(
        self, payload: movement_software_target_pb2.ArmBoardTargetMovement
    ) -> bytes:
        """Convert a payload to its ROS message, serialized as CDR."""
        return _LAYOUT.pack(
            cdr.LITTLE_ENDIAN,
            payload.target_x,
            payload.target_y,
            payload.target_z,
            payload.rotation_angle,
            payload.open_jaw,
            payload.final_gripper_angle,
        )
