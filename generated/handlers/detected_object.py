# Generated from mapping.yaml (row detected_object) and components/basestation/detected_object.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row detected_object: BasestationDetectedObject and comms/msg/BasestationDetectedObject."""

from __future__ import annotations

from generated.conversions import bounding_box
from generated.messages import BasestationDetectedObject
from generated.pb2.components.basestation import detected_object_pb2
from roverlink.runtime.core.handler import Handler, Route


class DetectedObjectHandler(
    Handler[detected_object_pb2.BasestationDetectedObject, BasestationDetectedObject]
):
    """One object seen in one camera frame. A frame with N objects travels as N messages.

    Number 17 of the envelope, from the topic detected_object to the peer basestation.
    """

    route = Route(
        number=17,
        name="detected_object",
        topic="detected_object",
        direction="ros_to_basestation",
    )
    payload_type = detected_object_pb2.BasestationDetectedObject
    message_type = BasestationDetectedObject

    @staticmethod
    def to_ros(
        payload: detected_object_pb2.BasestationDetectedObject,
    ) -> BasestationDetectedObject:
        """Convert BasestationDetectedObject to comms/msg/BasestationDetectedObject."""
        return BasestationDetectedObject(
            frame_id=payload.frame_id,
            total_count=payload.total_count,
            index=payload.index,
            id=payload.id,
            type=payload.type,
            bbox=bounding_box.to_ros(payload.bbox),
            confidence=payload.confidence,
        )

    @staticmethod
    def from_ros(
        message: BasestationDetectedObject,
    ) -> detected_object_pb2.BasestationDetectedObject:
        """Convert comms/msg/BasestationDetectedObject to BasestationDetectedObject."""
        return detected_object_pb2.BasestationDetectedObject(
            frame_id=message.frame_id,
            total_count=message.total_count,
            index=message.index,
            id=message.id,
            type=message.type,
            bbox=bounding_box.from_ros(message.bbox),
            confidence=message.confidence,
        )
