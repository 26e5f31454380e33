# Generated from mapping.yaml (row rock_measure_request) and components/basestation/rock_measure_request.proto; do not edit.
# Regenerate with: roverlink generate
"""rock_measure_request (19): BasestationRockMeasureRequest to comms/msg/BasestationRockMeasureRequest on rock_measure_request."""

from __future__ import annotations

from generated.messages import BasestationRockMeasureRequest
from generated.pb2.components.basestation import rock_measure_request_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Handler, Route

_CDR = cdr.fixed_layout(BasestationRockMeasureRequest)


class RockMeasureRequestHandler(
    Handler[
        rock_measure_request_pb2.BasestationRockMeasureRequest,
        BasestationRockMeasureRequest,
    ],
):
    """BasestationRockMeasureRequest to the topic rock_measure_request."""

    route = Route(
        number=19,
        name="rock_measure_request",
        topic="rock_measure_request",
        direction="basestation_to_ros",
    )
    payload_type = rock_measure_request_pb2.BasestationRockMeasureRequest
    message_type = BasestationRockMeasureRequest

    @staticmethod
    def to_ros(
        payload: rock_measure_request_pb2.BasestationRockMeasureRequest,
    ) -> BasestationRockMeasureRequest:
        """The message that says what the payload says."""
        return BasestationRockMeasureRequest(
            x1=payload.x1,
            y1=payload.y1,
            x2=payload.x2,
            y2=payload.y2,
        )

    @staticmethod
    def from_ros(
        message: BasestationRockMeasureRequest,
    ) -> rock_measure_request_pb2.BasestationRockMeasureRequest:
        """The payload that says what the message says."""
        return rock_measure_request_pb2.BasestationRockMeasureRequest(
            x1=message.x1,
            y1=message.y1,
            x2=message.x2,
            y2=message.y2,
        )

    def pack(
        self,
        payload: rock_measure_request_pb2.BasestationRockMeasureRequest,
    ) -> bytes:
        """`to_ros` and its serialization in one step: the values in the order of the .msg."""
        return _CDR.pack(
            cdr.LITTLE_ENDIAN,
            payload.x1,
            payload.y1,
            payload.x2,
            payload.y2,
        )
