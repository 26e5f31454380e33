# Generated from mapping.yaml (row ph_info) and components/sensor_board/ph_sensor.proto; do not edit.
# Regenerate with: roverlink generate
"""ph_info (1): SensorBoardPHInfo to comms/msg/SensorBoardPHInfo on ph_data."""

from __future__ import annotations

from generated.messages import SensorBoardPHInfo, SensorState
from generated.pb2.components.sensor_board import ph_sensor_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Handler, Route

_CDR = cdr.fixed_layout(SensorBoardPHInfo)


class PhInfoHandler(Handler[ph_sensor_pb2.SensorBoardPHInfo, SensorBoardPHInfo]):
    """SensorBoardPHInfo to the topic ph_data."""

    route = Route(
        number=1,
        name="ph_info",
        topic="ph_data",
        direction="hardware_to_ros",
        forward=("basestation",),
    )
    payload_type = ph_sensor_pb2.SensorBoardPHInfo
    message_type = SensorBoardPHInfo

    @staticmethod
    def to_ros(payload: ph_sensor_pb2.SensorBoardPHInfo) -> SensorBoardPHInfo:
        """The message that says what the payload says."""
        return SensorBoardPHInfo(
            ph_value=payload.ph_value,
            voltage=payload.voltage,
            temperature=payload.temperature,
            state=SensorState(state=payload.state),
            error_code=payload.error_code,
        )

    @staticmethod
    def from_ros(message: SensorBoardPHInfo) -> ph_sensor_pb2.SensorBoardPHInfo:
        """The payload that says what the message says."""
        return ph_sensor_pb2.SensorBoardPHInfo(
            ph_value=message.ph_value,
            voltage=message.voltage,
            temperature=message.temperature,
            state=message.state.state,
            error_code=message.error_code,
        )

    def pack(self, payload: ph_sensor_pb2.SensorBoardPHInfo) -> bytes:
        """`to_ros` and its serialization in one step: the values in the order of the .msg."""
        return _CDR.pack(
            cdr.LITTLE_ENDIAN,
            payload.ph_value,
            payload.voltage,
            payload.temperature,
            payload.state,
            payload.error_code,
        )
