# Generated from mapping.yaml (row gps_info) and components/sensor_board/gps_sensor.proto; do not edit.
# Regenerate with: roverlink generate
"""Fast serialization of SensorBoardGPSInfo as comms/msg/SensorBoardGPSInfo.

The registry uses this class; programs import `GpsInfoHandler`
from `generated.handlers.gps_info`.
"""

from __future__ import annotations

from generated.handlers.gps_info import GpsInfoHandler
from generated.messages import SensorBoardGPSInfo
from generated.pb2.components.sensor_board import gps_sensor_pb2
from roverlink.runtime.core import cdr

_LAYOUT = cdr.fixed_layout(SensorBoardGPSInfo)


class FastGpsInfoHandler(GpsInfoHandler):
    """GpsInfoHandler that converts a payload to a serialized ROS message in one step."""

    def _pack(self, payload: gps_sensor_pb2.SensorBoardGPSInfo) -> bytes:
        """Convert a payload to its ROS message, serialized as CDR."""
        return _LAYOUT.pack(
            cdr.LITTLE_ENDIAN,
            payload.latitude,
            payload.longitude,
            payload.altitude,
            payload.speed,
            payload.heading,
            payload.hdop,
            payload.vdop,
            payload.satellites,
            payload.fix_quality,
            payload.state,
            payload.error_code,
            payload.utc_timestamp,
        )
