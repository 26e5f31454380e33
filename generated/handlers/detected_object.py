# Generated from mapping.yaml (row detected_object) and components/basestation/detected_object.proto; do not edit.
# Regenerate with: roverlink generate
"""detected_object (17): BasestationDetectedObject from comms/msg/BasestationDetectedObject on detected_object."""

from __future__ import annotations

from generated.conversions import bounding_box
from generated.messages import BasestationDetectedObject
from generated.pb2.components.basestation import detected_object_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Handler, Route

_CDR = cdr.fixed_layout(BasestationDetectedObject)


class DetectedObjectHandler(
    Handler[detected_object_pb2.BasestationDetectedObject, BasestationDetectedObject],
):
    """BasestationDetectedObject from the topic detected_object."""

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
        """The message that says what the payload says."""
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
        """The payload that says what the message says."""
        return detected_object_pb2.BasestationDetectedObject(
            frame_id=message.frame_id,
            total_count=message.total_count,
            index=message.index,
            id=message.id,
            type=message.type,
            bbox=bounding_box.from_ros(message.bbox),
            confidence=message.confidence,
        )

    def pack(self, payload: detected_object_pb2.BasestationDetectedObject) -> bytes:
        """`to_ros` and its serialization in one step: the values in the order of the .msg."""
        bbox = payload.bbox
        return _CDR.pack(
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
