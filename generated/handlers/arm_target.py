# Generated from mapping.yaml (row arm_target) and components/arm_board/movement_software_target.proto; do not edit.
# Regenerate with: roverlink generate
"""arm_target (6): ArmBoardTargetMovement from comms/msg/ArmBoardTargetMovement on arm_target."""

from __future__ import annotations

from generated.messages import ArmBoardTargetMovement
from generated.pb2.components.arm_board import movement_software_target_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Handler, Route

_CDR = cdr.fixed_layout(ArmBoardTargetMovement)


class ArmTargetHandler(
    Handler[
        movement_software_target_pb2.ArmBoardTargetMovement,
        ArmBoardTargetMovement,
    ],
):
    """ArmBoardTargetMovement from the topic arm_target."""

    route = Route(
        number=6,
        name="arm_target",
        topic="arm_target",
        direction="ros_to_hardware",
    )
    payload_type = movement_software_target_pb2.ArmBoardTargetMovement
    message_type = ArmBoardTargetMovement

    @staticmethod
    def to_ros(
        payload: movement_software_target_pb2.ArmBoardTargetMovement,
    ) -> ArmBoardTargetMovement:
        """The message that says what the payload says."""
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
        """The payload that says what the message says."""
        return movement_software_target_pb2.ArmBoardTargetMovement(
            target_x=message.target_x,
            target_y=message.target_y,
            target_z=message.target_z,
            rotation_angle=message.rotation_angle,
            open_jaw=message.open_jaw,
            final_gripper_angle=message.final_gripper_angle,
        )

    def pack(
        self,
        payload: movement_software_target_pb2.ArmBoardTargetMovement,
    ) -> bytes:
        """`to_ros` and its serialization in one step: the values in the order of the .msg."""
        return _CDR.pack(
            cdr.LITTLE_ENDIAN,
            payload.target_x,
            payload.target_y,
            payload.target_z,
            payload.rotation_angle,
            payload.open_jaw,
            payload.final_gripper_angle,
        )
