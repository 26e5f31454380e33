# Generated from mapping.yaml (row control_mode) and components/basestation/control_mode.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row control_mode: BasestationControlMode and comms/msg/BasestationControlMode."""

from __future__ import annotations

from generated.messages import BasestationControlMode
from generated.pb2.components.basestation import control_mode_pb2
from roverlink.runtime.core.handler import Handler, Route


class ControlModeHandler(
    Handler[control_mode_pb2.BasestationControlMode, BasestationControlMode]
):
    """Choice of the driver: the operator or the rover itself.

    Number 16 of the envelope, from the peer basestation to the topic control_mode.
    """

    route = Route(
        number=16,
        name="control_mode",
        topic="control_mode",
        direction="basestation_to_ros",
    )
    payload_type = control_mode_pb2.BasestationControlMode
    message_type = BasestationControlMode

    @staticmethod
    def to_ros(
        payload: control_mode_pb2.BasestationControlMode,
    ) -> BasestationControlMode:
        """Convert BasestationControlMode to comms/msg/BasestationControlMode."""
        return BasestationControlMode(
            mode=payload.mode,
        )

    @staticmethod
    def from_ros(
        message: BasestationControlMode,
    ) -> control_mode_pb2.BasestationControlMode:
        """Convert comms/msg/BasestationControlMode to BasestationControlMode."""
        return control_mode_pb2.BasestationControlMode(
            mode=message.mode,
        )
