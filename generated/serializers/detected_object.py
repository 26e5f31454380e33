# Generated from mapping.yaml (row detected_object) and components/basestation/detected_object.proto; do not edit.
# Regenerate with: roverlink generate
"""Fast serialization of BasestationDetectedObject as comms/msg/BasestationDetectedObject.

The registry uses this class; programs import `DetectedObjectHandler`
from `generated.handlers.detected_object`.
"""

from __future__ import annotations

from generated.handlers.detected_object import DetectedObjectHandler
from generated.messages import BasestationDetectedObject
from generated.pb2.components.basestation import detected_object_pb2
from roverlink.runtime.core import cdr

_LAYOUT = cdr.fixed_layout(BasestationDetectedObject)


class FastDetectedObjectHandler(DetectedObjectHandler):
    """DetectedObjectHandler that converts a payload to a serialized ROS message in one step."""

    def _pack(self, payload: detected_object_pb2.BasestationDetectedObject) -> bytes:
        """Convert a payload to its ROS message, serialized as CDR."""
        bbox = payload.bbox
        return _LAYOUT.pack(
            cdr.LITTLE_ENDIAN,
            payload.frame_id,
            payload.total_count,
            payload.index,
            payload.id,
            payload.type,
            bbox.x,
            bbox.y,
            bbox.width,
            bbox.height,
            payload.confidence,
        )
