# Generated from mapping.yaml (row arm_obstructions) and components/arm_board/movement_software_target.proto; do not edit.
# Regenerate with: roverlink generate
"""arm_obstructions (7): ArmBoardObstructions to comms/msg/ArmBoardObstructions on arm_obstructions."""

from __future__ import annotations

from generated.messages import ArmBoardObstructions
from generated.pb2.components.arm_board import movement_software_target_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Handler, Route

_CDR = cdr.fixed_layout(ArmBoardObstructions)


class ArmObstructionsHandler(
    Handler[movement_software_target_pb2.ArmBoardObstructions, ArmBoardObstructions],
):
    """ArmBoardObstructions to the topic arm_obstructions."""

    route = Route(
        number=7,
        name="arm_obstructions",
        topic="arm_obstructions",
        direction="hardware_to_ros",
        forward=("basestation",),
    )
    payload_type = movement_software_target_pb2.ArmBoardObstructions
    message_type = ArmBoardObstructions

    @staticmethod
    def to_ros(
        payload: movement_software_target_pb2.ArmBoardObstructions,
    ) -> ArmBoardObstructions:
        """The message that says what the payload says."""
        return ArmBoardObstructions(obstructions_list=payload.obstructions_list)

    @staticmethod
    def from_ros(
        message: ArmBoardObstructions,
    ) -> movement_software_target_pb2.ArmBoardObstructions:
        """The payload that says what the message says."""
        return movement_software_target_pb2.ArmBoardObstructions(
            obstructions_list=message.obstructions_list,
        )

    def pack(self, payload: movement_software_target_pb2.ArmBoardObstructions) -> bytes:
        """`to_ros` and its serialization in one step: the values in the order of the .msg."""
        return _CDR.pack(cdr.LITTLE_ENDIAN, payload.obstructions_list)
