# Generated from mapping.yaml (row arm_obstructions) and components/arm_board/movement_software_target.proto; do not edit.
# Regenerate with: roverlink generate
"""Fast serialization of ArmBoardObstructions as comms/msg/ArmBoardObstructions.

The registry uses this class; programs import `ArmObstructionsHandler`
from `generated.handlers.arm_obstructions`.
"""

from __future__ import annotations

from generated.handlers.arm_obstructions import ArmObstructionsHandler
from generated.messages import ArmBoardObstructions
from generated.pb2.components.arm_board import movement_software_target_pb2
from roverlink.runtime.core import cdr

_LAYOUT = cdr.fixed_layout(ArmBoardObstructions)


class FastArmObstructionsHandler(ArmObstructionsHandler):
    """ArmObstructionsHandler that converts a payload to a serialized ROS message in one step."""

    def _pack(
        self, payload: movement_software_target_pb2.ArmBoardObstructions
    ) -> bytes:
        """Convert a payload to its ROS message, serialized as CDR."""
        return _LAYOUT.pack(
            cdr.LITTLE_ENDIAN,
            payload.obstructions_list,
        )
