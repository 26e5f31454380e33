# Generated from mapping.yaml (row ph_info) and components/sensor_board/ph_sensor.proto; do not edit.
# Regenerate with: roverlink generate
"""Fast serialization of SensorBoardPHInfo as comms/msg/SensorBoardPHInfo.

The registry uses this class; programs import `PhInfoHandler`
from `generated.handlers.ph_info`.
"""

from __future__ import annotations

from generated.handlers.ph_info import PhInfoHandler
from generated.messages import SensorBoardPHInfo
from generated.pb2.components.sensor_board import ph_sensor_pb2
from roverlink.runtime.core import cdr

_LAYOUT = cdr.fixed_layout(SensorBoardPHInfo)


class FastPhInfoHandler(PhInfoHandler):
    """PhInfoHandler that converts a payload to a serialized ROS message in one step."""

    def _pack(self, payload: ph_sensor_pb2.SensorBoardPHInfo) -> bytes:
        """Convert a payload to its ROS message, serialized as CDR."""
        return _LAYOUT.pack(
            cdr.LITTLE_ENDIAN,
            payload.ph_value,
            payload.voltage,
            payload.temperature,
            payload.state,
            payload.error_code,
        )
