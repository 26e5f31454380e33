# Generated from mapping.yaml (row pressure_info) and components/sensor_board/pressure_sensor.proto; do not edit.
# Regenerate with: roverlink generate
"""Fast serialization of SensorBoardPressureInfo as comms/msg/SensorBoardPressureInfo.

The registry uses this class; programs import `PressureInfoHandler`
from `generated.handlers.pressure_info`.
"""

from __future__ import annotations

from generated.handlers.pressure_info import PressureInfoHandler
from generated.messages import SensorBoardPressureInfo
from generated.pb2.components.sensor_board import pressure_sensor_pb2
from roverlink.runtime.core import cdr

_LAYOUT = cdr.fixed_layout(SensorBoardPressureInfo)


class FastPressureInfoHandler(PressureInfoHandler):
    """PressureInfoHandler that converts a payload to a serialized ROS message in one step."""

    def _pack(self, payload: pressure_sensor_pb2.SensorBoardPressureInfo) -> bytes:
        """Convert a payload to its ROS message, serialized as CDR."""
        return _LAYOUT.pack(
            cdr.LITTLE_ENDIAN,
            payload.sensor_index,
            payload.pressure_kpa,
            payload.temperature_c,
            payload.voltage,
            payload.is_calibrated,
            payload.state,
            payload.error_code,
        )
