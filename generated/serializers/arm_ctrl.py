# Generated from mapping.yaml (row arm_ctrl) and components/arm_board/movement_control_in.proto; do not edit.
# Regenerate with: roverlink generate
"""Fast serialization of ArmBoardControlSignals as comms/msg/ArmBoardControlSignals.

The registry uses this class; programs import `ArmCtrlHandler`
from `generated.handlers.arm_ctrl`.
"""

from __future__ import annotations

from generated.handlers.arm_ctrl import ArmCtrlHandler
from generated.messages import ArmBoardControlSignals
from generated.pb2.components.arm_board import movement_control_in_pb2
from roverlink.runtime.core import cdr

_LAYOUT = cdr.fixed_layout(ArmBoardControlSignals)


class FastArmCtrlHandler(ArmCtrlHandler):
    """ArmCtrlHandler that converts a payload to a serialized ROS message in one step."""

    def _pack(self, payload: movement_control_in_pb2.ArmBoardControlSignals) -> bytes:
        """Convert a payload to its ROS message, serialized as CDR."""
        return _LAYOUT.pack(
            cdr.LITTLE_ENDIAN,
            payload.control_gripper_rotation,
            payload.control_gripper_pitch,
            payload.control_base,
            payload.control_jaw,
            payload.stepper_top_ena,
            payload.stepper_top_rev,
            payload.stepper_bottom_ena,
            payload.stepper_bottom_rev,
        )
