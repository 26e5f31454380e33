# Generated from mapping.yaml (row gps_info) and components/sensor_board/gps_sensor.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row gps_info: SensorBoardGPSInfo and comms/msg/SensorBoardGPSInfo."""

from __future__ import annotations

from generated.messages import SensorBoardGPSInfo, SensorState
from generated.pb2.components.sensor_board import gps_sensor_pb2
from roverlink.runtime.core.handler import Handler, Route


class GpsInfoHandler(Handler[gps_sensor_pb2.SensorBoardGPSInfo, SensorBoardGPSInfo]):
    """One fix of the GPS receiver.

    Number 12 of the envelope, from the peer hardware to the topic gps_data.
    """

    route = Route(
        number=12,
        name="gps_info",
        topic="gps_data",
        direction="hardware_to_ros",
        forward=("basestation",),
        board="SensorBoard",
    )
    payload_type = gps_sensor_pb2.SensorBoardGPSInfo
    message_type = SensorBoardGPSInfo

    @staticmethod
    def to_ros(payload: gps_sensor_pb2.SensorBoardGPSInfo) -> SensorBoardGPSInfo:
        """Convert SensorBoardGPSInfo to comms/msg/SensorBoardGPSInfo."""
        return SensorBoardGPSInfo(
            latitude=payload.latitude,
            longitude=payload.longitude,
            altitude=payload.altitude,
            speed=payload.speed,
            heading=payload.heading,
            hdop=payload.hdop,
            vdop=payload.vdop,
            satellites=payload.satellites,
            fix_quality=payload.fix_quality,
            state=SensorState(state=payload.state),
            error_code=payload.error_code,
            utc_timestamp=payload.utc_timestamp,
        )

    @staticmethod
    def from_ros(message: SensorBoardGPSInfo) -> gps_sensor_pb2.SensorBoardGPSInfo:
        """Convert comms/msg/SensorBoardGPSInfo to SensorBoardGPSInfo."""
        return gps_sensor_pb2.SensorBoardGPSInfo(
            latitude=message.latitude,
            longitude=message.longitude,
            altitude=message.altitude,
            speed=message.speed,
            heading=message.heading,
            hdop=message.hdop,
            vdop=message.vdop,
            satellites=message.satellites,
            fix_quality=message.fix_quality,
            state=message.state.state,
            error_code=message.error_code,
            utc_timestamp=message.utc_timestamp,
        )
