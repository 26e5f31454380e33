# Generated from mapping.yaml (row load_cell_info) and components/sensor_board/load_cell.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row load_cell_info: SensorBoardLoadCellInfo and comms/msg/SensorBoardLoadCellInfo."""

from __future__ import annotations

from generated.messages import SensorBoardLoadCellInfo, SensorState
from generated.pb2.components.sensor_board import load_cell_pb2
from roverlink.runtime.core.handler import Handler, Route


class LoadCellInfoHandler(
    Handler[load_cell_pb2.SensorBoardLoadCellInfo, SensorBoardLoadCellInfo]
):
    """One reading of a load cell.

    Number 14 of the envelope, from the peer hardware to the topic load_cell_info.
    """

    route = Route(
        number=14,
        name="load_cell_info",
        topic="load_cell_info",
        direction="hardware_to_ros",
        forward=("basestation",),
        board="SensorBoard",
    )
    payload_type = load_cell_pb2.SensorBoardLoadCellInfo
    message_type = SensorBoardLoadCellInfo

    @staticmethod
    def to_ros(
        payload: load_cell_pb2.SensorBoardLoadCellInfo,
    ) -> SensorBoardLoadCellInfo:
        """Convert SensorBoardLoadCellInfo to comms/msg/SensorBoardLoadCellInfo."""
        return SensorBoardLoadCellInfo(
            sensor_index=payload.sensor_index,
            force_newtons=payload.force_newtons,
            mass_grams=payload.mass_grams,
            raw_counts=payload.raw_counts,
            is_calibrated=payload.is_calibrated,
            scale_newtons_per_count=payload.scale_newtons_per_count,
            tare_offset_counts=payload.tare_offset_counts,
            state=SensorState(state=payload.state),
            error_code=payload.error_code,
        )

    @staticmethod
    def from_ros(
        message: SensorBoardLoadCellInfo,
    ) -> load_cell_pb2.SensorBoardLoadCellInfo:
        """Convert comms/msg/SensorBoardLoadCellInfo to SensorBoardLoadCellInfo."""
        return load_cell_pb2.SensorBoardLoadCellInfo(
            sensor_index=message.sensor_index,
            force_newtons=message.force_newtons,
            mass_grams=message.mass_grams,
            raw_counts=message.raw_counts,
            is_calibrated=message.is_calibrated,
            scale_newtons_per_count=message.scale_newtons_per_count,
            tare_offset_counts=message.tare_offset_counts,
            state=message.state.state,
            error_code=message.error_code,
        )
