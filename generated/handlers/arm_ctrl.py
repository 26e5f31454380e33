# Generated from mapping.yaml (row arm_ctrl) and components/arm_board/movement_control_in.proto; do not edit.
# Regenerate with: roverlink generate
"""arm_ctrl (2): ArmBoardControlSignals from comms/msg/ArmBoardControlSignals on arm_ctrl."""

from __future__ import annotations

from generated.messages import ArmBoardControlSignals
from generated.pb2.components.arm_board import movement_control_in_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Deadman, Handler, Route

_CDR = cdr.fixed_layout(ArmBoardControlSignals)


class ArmCtrlHandler(
    Handler[movement_control_in_pb2.ArmBoardControlSignals, ArmBoardControlSignals],
):
    """ArmBoardControlSignals from the topic arm_ctrl."""

    route = Route(
        number=2,
        name="arm_ctrl",
        topic="arm_ctrl",
        direction="ros_to_hardware",
        deadman=Deadman(after_ms=500, repeat_ms=1000, send={}),
        priority=9,
    )
    payload_type = movement_control_in_pb2.ArmBoardControlSignals
    message_type = ArmBoardControlSignals

    @staticmethod
    def to_ros(
        payload: movement_control_in_pb2.ArmBoardControlSignals,
    ) -> ArmBoardControlSignals:
        """The message that says what the payload says."""
        return ArmBoardControlSignals(
            control_gripper_rotation=payload.control_gripper_rotation,
            control_gripper_pitch=payload.control_gripper_pitch,
            control_base=payload.control_base,
            control_jaw=payload.control_jaw,
            stepper_top_ena=payload.stepper_top_ena,
            stepper_top_rev=payload.stepper_top_rev,
            stepper_bottom_ena=payload.stepper_bottom_ena,
            stepper_bottom_rev=payload.stepper_bottom_rev,
        )

    @staticmethod
    def from_ros(
        message: ArmBoardControlSignals,
    ) -> movement_control_in_pb2.ArmBoardControlSignals:
        """The payload that says what the message says."""
        return movement_control_in_pb2.ArmBoardControlSignals(
            control_gripper_rotation=message.control_gripper_rotation,
            control_gripper_pitch=message.control_gripper_pitch,
            control_base=message.control_base,
            control_jaw=message.control_jaw,
            stepper_top_ena=message.stepper_top_ena,
            stepper_top_rev=message.stepper_top_rev,
            stepper_bottom_ena=message.stepper_bottom_ena,
            stepper_bottom_rev=message.stepper_bottom_rev,
        )

    def pack(self, payload: movement_control_in_pb2.ArmBoardControlSignals) -> bytes:
        """`to_ros` and its serialization in one step: the values in the order of the .msg."""
        return _CDR.pack(
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
