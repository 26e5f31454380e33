# Generated from mapping.yaml (row rock_measure_request) and components/basestation/rock_measure_request.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row rock_measure_request: BasestationRockMeasureRequest and comms/msg/BasestationRockMeasureRequest."""

from __future__ import annotations

from generated.messages import BasestationRockMeasureRequest
from generated.pb2.components.basestation import rock_measure_request_pb2
from roverlink.runtime.core.handler import Handler, Route


class RockMeasureRequestHandler(
    Handler[
        rock_measure_request_pb2.BasestationRockMeasureRequest,
        BasestationRockMeasureRequest,
    ]
):
    """The line on the image, from (x1, y1) to (x2, y2) in pixels, along which a rock is to be measured.

    Number 19 of the envelope, from the peer basestation to the topic
    rock_measure_request.
    """

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
        """Convert BasestationRockMeasureRequest to comms/msg/BasestationRockMeasureRequest."""
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
        """Convert comms/msg/BasestationRockMeasureRequest to BasestationRockMeasureRequest."""
        return rock_measure_request_pb2.BasestationRockMeasureRequest(
            x1=message.x1,
            y1=message.y1,
            x2=message.x2,
            y2=message.y2,
        )
