# Generated from mapping.yaml (row rock_measure_result) and components/basestation/rock_measure_result.proto; do not edit.
# Regenerate with: roverlink generate
"""Fast serialization of BasestationRockMeasureResult as comms/msg/BasestationRockMeasureResult.

The registry uses this class; programs import `RockMeasureResultHandler`
from `generated.handlers.rock_measure_result`.
"""

from __future__ import annotations

from generated.handlers.rock_measure_result import RockMeasureResultHandler
from generated.messages import BasestationRockMeasureResult
from generated.pb2.components.basestation import rock_measure_result_pb2
from roverlink.runtime.core import cdr

_LAYOUT = cdr.fixed_layout(BasestationRockMeasureResult)


class FastRockMeasureResultHandler(RockMeasureResultHandler):
    """RockMeasureResultHandler that converts a payload to a serialized ROS message in one step."""

    def _pack(
        self, payload: rock_measure_result_pb2.BasestationRockMeasureResult
    ) -> bytes:
        """Convert a payload to its ROS message, serialized as CDR."""
        return _LAYOUT.pack(
            cdr.LITTLE_ENDIAN,
            payload.length_cm,
            payload.width_cm,
        )
