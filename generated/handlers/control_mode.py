# Generated from mapping.yaml (row control_mode) and components/basestation/control_mode.proto; do not edit.
# Regenerate with: roverlink generate
"""control_mode (16): BasestationControlMode to comms/msg/BasestationControlMode on control_mode."""

from __future__ import annotations

from generated.messages import BasestationControlMode
from generated.pb2.components.basestation import control_mode_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Handler, Route

_CDR = cdr.fixed_layout(BasestationControlMode)


class ControlModeHandler(
    Handler[control_mode_pb2.BasestationControlMode, BasestationControlMode],
):
    """BasestationControlMode to the topic control_mode."""

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
        """The message that says what the payload says."""
        return BasestationControlMode(mode=payload.mode)

    @staticmethod
    def from_ros(
        message: BasestationControlMode,
    ) -> control_mode_pb2.BasestationControlMode:
        """The payload that says what the message says."""
        return control_mode_pb2.BasestationControlMode(mode=message.mode)

    def pack(self, payload: control_mode_pb2.BasestationControlMode) -> bytes:
        """`to_ros` and its serialization in one step: the values in the order of the .msg."""
        return _CDR.pack(cdr.LITTLE_ENDIAN, payload.mode)
