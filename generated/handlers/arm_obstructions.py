# Generated from mapping.yaml (row arm_obstructions) and components/arm_board/movement_software_target.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row arm_obstructions: ArmBoardObstructions and comms/msg/ArmBoardObstructions."""

from __future__ import annotations

from generated.messages import ArmBoardObstructions
from generated.pb2.components.arm_board import movement_software_target_pb2
from roverlink.runtime.core.handler import Handler, Route


class ArmObstructionsHandler(
    Handler[movement_software_target_pb2.ArmBoardObstructions, ArmBoardObstructions]
):
    """Obstacles in the way of the arm.

    Number 7 of the envelope, from the peer hardware to the topic arm_obstructions.
    """

    route = Route(
        number=7,
        name="arm_obstructions",
        topic="arm_obstructions",
        direction="hardware_to_ros",
        forward=("basestation",),
        board="ArmBoard",
    )
    payload_type = movement_software_target_pb2.ArmBoardObstructions
    message_type = ArmBoardObstructions

    @staticmethod
    def to_ros(
        payload: movement_software_target_pb2.ArmBoardObstructions,
    ) -> ArmBoardObstructions:
        """Convert ArmBoardObstructions to comms/msg/ArmBoardObstructions."""
        return ArmBoardObstructions(
            obstructions_list=payload.obstructions_list,
        )

    @staticmethod
    def from_ros(
        message: ArmBoardObstructions,
    ) -> movement_software_target_pb2.ArmBoardObstructions:
        """Convert comms/msg/ArmBoardObstructions to ArmBoardObstructions."""
        return movement_software_target_pb2.ArmBoardObstructions(
            obstructions_list=message.obstructions_list,
        )
