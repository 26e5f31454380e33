# Generated from mapping.yaml (row load_cell_info) and components/sensor_board/load_cell.proto; do not edit.
# Regenerate with: roverlink generate
"""Fast serialization of SensorBoardLoadCellInfo as comms/msg/SensorBoardLoadCellInfo.

The registry uses this class; programs import `LoadCellInfoHandler`
from `generated.handlers.load_cell_info`.
"""

from __future__ import annotations

from generated.handlers.load_cell_info import LoadCellInfoHandler
from generated.messages import SensorBoardLoadCellInfo
from generated.pb2.components.sensor_board import load_cell_pb2
from roverlink.runtime.core import cdr

_LAYOUT = cdr.fixed_layout(SensorBoardLoadCellInfo)


class FastLoadCellInfoHandler(LoadCellInfoHandler):
    """LoadCellInfoHandler that converts a payload to a serialized ROS message in one step."""

    def _pack(self, payload: load_cell_pb2.SensorBoardLoadCellInfo) -> bytes:
        """Convert a payload to its ROS message, serialized as CDR."""
        return _LAYOUT.pack(
            cdr.LITTLE_ENDIAN,
            payload.sensor_index,
            payload.force_newtons,
            payload.mass_grams,
            payload.raw_counts,
            payload.is_calibrated,
            payload.scale_newtons_per_count,
            payload.tare_offset_counts,
            payload.state,
            payload.error_code,
        )
