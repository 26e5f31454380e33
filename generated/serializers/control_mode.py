# Generated from mapping.yaml (row control_mode) and components/basestation/control_mode.proto; do not edit.
# Regenerate with: roverlink generate
"""Fast serialization of BasestationControlMode as comms/msg/BasestationControlMode.

The registry uses this class; programs import `ControlModeHandler`
from `generated.handlers.control_mode`.
"""

from __future__ import annotations

from generated.handlers.control_mode import ControlModeHandler
from generated.messages import BasestationControlMode
from generated.pb2.components.basestation import control_mode_pb2
from roverlink.runtime.core import cdr

_LAYOUT = cdr.fixed_layout(BasestationControlMode)


class FastControlModeHandler(ControlModeHandler):
    """ControlModeHandler that converts a payload to a serialized ROS message in one step."""

    def _pack(self, payload: control_mode_pb2.BasestationControlMode) -> bytes:
        """Convert a payload to its ROS message, serialized as CDR."""
        return _LAYOUT.pack(
            cdr.LITTLE_ENDIAN,
            payload.mode,
        )
