# Generated from mapping.yaml (row rock_measure_request) and components/basestation/rock_measure_request.proto; do not edit.
# Regenerate with: roverlink generate
"""Fast serialization of BasestationRockMeasureRequest as comms/msg/BasestationRockMeasureRequest.

The registry uses this class; programs import `RockMeasureRequestHandler`
from `generated.handlers.rock_measure_request`.
"""

from __future__ import annotations

from generated.handlers.rock_measure_request import RockMeasureRequestHandler
from generated.messages import BasestationRockMeasureRequest
from generated.pb2.components.basestation import rock_measure_request_pb2
from roverlink.runtime.core import cdr

_LAYOUT = cdr.fixed_layout(BasestationRockMeasureRequest)


class FastRockMeasureRequestHandler(RockMeasureRequestHandler):
    """RockMeasureRequestHandler that converts a payload to a serialized ROS message in one step."""

    def _pack(
        self, payload: rock_measure_request_pb2.BasestationRockMeasureRequest
    ) -> bytes:
        """Convert a payload to its ROS message, serialized as CDR."""
        return _LAYOUT.pack(
            cdr.LITTLE_ENDIAN,
            payload.x1,
            payload.y1,
            payload.x2,
            payload.y2,
        )
