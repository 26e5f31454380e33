# Generated from mapping.yaml (row arm_pos) and components/arm_board/movement_software_feedback.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row arm_pos: ArmBoardActualPositions and comms/msg/ArmBoardActualPositions."""

from __future__ import annotations

from generated.messages import ArmBoardActualPositions
from generated.pb2.components.arm_board import movement_software_feedback_pb2
from roverlink.runtime.core.handler import Handler, Route


class ArmPosHandler(
    Handler[
        movement_software_feedback_pb2.ArmBoardActualPositions, ArmBoardActualPositions
    ]
):
    """Positions of the arm's joints.

    Number 5 of the envelope, from the peer hardware to the topic arm_pos.
    """

    route = Route(
        number=5,
        name="arm_pos",
        topic="arm_pos",
        direction="hardware_to_ros",
        forward=("basestation",),
        board="ArmBoard",
    )
    payload_type = movement_software_feedback_pb2.ArmBoardActualPositions
    message_type = ArmBoardActualPositions

    @staticmethod
    def to_ros(
        payload: movement_software_feedback_pb2.ArmBoardActualPositions,
    ) -> ArmBoardActualPositions:
        """Convert ArmBoardActualPositions to comms/msg/ArmBoardActualPositions."""
        return ArmBoardActualPositions(
            jaw_open=payload.jaw_open,
            jaw_actual_position=payload.jaw_actual_position,
            base_actual_position=payload.base_actual_position,
            stepper_top_actual_position=payload.stepper_top_actual_position,
            stepper_bottom_actual_position=payload.stepper_bottom_actual_position,
            gripper_rotation_actual_position=payload.gripper_rotation_actual_position,
            gripper_pitch_actual_position=payload.gripper_pitch_actual_position,
        )

    @staticmethod
    def from_ros(
        message: ArmBoardActualPositions,
    ) -> movement_software_feedback_pb2.ArmBoardActualPositions:
        """Convert comms/msg/ArmBoardActualPositions to ArmBoardActualPositions."""
        return movement_software_feedback_pb2.ArmBoardActualPositions(
            jaw_open=message.jaw_open,
            jaw_actual_position=message.jaw_actual_position,
            base_actual_position=message.base_actual_position,
            stepper_top_actual_position=message.stepper_top_actual_position,
            stepper_bottom_actual_position=message.stepper_bottom_actual_position,
            gripper_rotation_actual_position=message.gripper_rotation_actual_position,
            gripper_pitch_actual_position=message.gripper_pitch_actual_position,
        )
