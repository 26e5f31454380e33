# Generated from mapping.yaml (row arm_target) and components/arm_board/movement_software_target.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row arm_target: ArmBoardTargetMovement and comms/msg/ArmBoardTargetMovement."""

from __future__ import annotations

from generated.messages import ArmBoardTargetMovement
from generated.pb2.components.arm_board import movement_software_target_pb2
from roverlink.runtime.core.handler import Handler, Route


class ArmTargetHandler(
    Handler[movement_software_target_pb2.ArmBoardTargetMovement, ArmBoardTargetMovement]
):
    """A pose that the arm is to reach by itself.

    Number 6 of the envelope, from the topic arm_target to the peer hardware.
    """

    route = Route(
        number=6,
        name="arm_target",
        topic="arm_target",
        direction="ros_to_hardware",
        board="ArmBoard",
    )
    payload_type = movement_software_target_pb2.ArmBoardTargetMovement
    message_type = ArmBoardTargetMovement

    @staticmethod
    def to_ros(
        payload: movement_software_target_pb2.ArmBoardTargetMovement,
    ) -> ArmBoardTargetMovement:
        """Convert ArmBoardTargetMovement to comms/msg/ArmBoardTargetMovement."""
        return ArmBoardTargetMovement(
            target_x=payload.target_x,
            target_y=payload.target_y,
            target_z=payload.target_z,
            rotation_angle=payload.rotation_angle,
            open_jaw=payload.open_jaw,
            final_gripper_angle=payload.final_gripper_angle,
        )

    @staticmethod
    def from_ros(
        message: ArmBoardTargetMovement,
    ) -> movement_software_target_pb2.ArmBoardTargetMovement:
        """Convert comms/msg/ArmBoardTargetMovement to ArmBoardTargetMovement."""
        return movement_software_target_pb2.ArmBoardTargetMovement(
            target_x=message.target_x,
            target_y=message.target_y,
            target_z=message.target_z,
            rotation_angle=message.rotation_angle,
            open_jaw=message.open_jaw,
            final_gripper_angle=message.final_gripper_angle,
        )
