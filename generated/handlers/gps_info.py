# Generated from mapping.yaml (row gps_info) and components/sensor_board/gps_sensor.proto; do not edit.
# Regenerate with: roverlink generate
"""gps_info (12): SensorBoardGPSInfo to comms/msg/SensorBoardGPSInfo on gps_data."""

from __future__ import annotations

from generated.messages import SensorBoardGPSInfo, SensorState
from generated.pb2.components.sensor_board import gps_sensor_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Handler, Route

_CDR = cdr.fixed_layout(SensorBoardGPSInfo)


class GpsInfoHandler(Handler[gps_sensor_pb2.SensorBoardGPSInfo, SensorBoardGPSInfo]):
    """SensorBoardGPSInfo to the topic gps_data."""

    route = Route(
        number=12,
        name="gps_info",
        topic="gps_data",
        direction="hardware_to_ros",
        forward=("basestation",),
    )
    payload_type = gps_sensor_pb2.SensorBoardGPSInfo
    message_type = SensorBoardGPSInfo

    @staticmethod
    def to_ros(payload: gps_sensor_pb2.SensorBoardGPSInfo) -> SensorBoardGPSInfo:
        """The message that says what the payload says."""
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
        """The payload that says what the message says."""
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

    def pack(self, payload: gps_sensor_pb2.SensorBoardGPSInfo) -> bytes:
        """`to_ros` and its serialization in one step: the values in the order of the .msg."""
        return _CDR.pack(
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
