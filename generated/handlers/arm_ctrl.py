# Generated from mapping.yaml (row arm_ctrl) and components/arm_board/movement_control_in.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row arm_ctrl: ArmBoardControlSignals and comms/msg/ArmBoardControlSignals."""

from __future__ import annotations

from generated.messages import ArmBoardControlSignals
from generated.pb2.components.arm_board import movement_control_in_pb2
from roverlink.runtime.core.handler import Deadman, Handler, Route


class ArmCtrlHandler(
    Handler[movement_control_in_pb2.ArmBoardControlSignals, ArmBoardControlSignals]
):
    """Direct control of the arm: one signal an actuator, as an operator drives it by hand.

    Number 2 of the envelope, from the topic arm_ctrl to the peer hardware.
    """

    route = Route(
        number=2,
        name="arm_ctrl",
        topic="arm_ctrl",
        direction="ros_to_hardware",
        deadman=Deadman(
            after_ms=500,
            repeat_ms=1000,
            send={},
        ),
        priority=9,
        board="ArmBoard",
    )
    payload_type = movement_control_in_pb2.ArmBoardControlSignals
    message_type = ArmBoardControlSignals

    @staticmethod
    def to_ros(
        payload: movement_control_in_pb2.ArmBoardControlSignals,
    ) -> ArmBoardControlSignals:
        """Convert ArmBoardControlSignals to comms/msg/ArmBoardControlSignals."""
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
        """Convert comms/msg/ArmBoardControlSignals to ArmBoardControlSignals."""
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
