# Generated from mapping.yaml (row rock_measure_result) and components/basestation/rock_measure_result.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row rock_measure_result: BasestationRockMeasureResult and comms/msg/BasestationRockMeasureResult."""

from __future__ import annotations

from generated.messages import BasestationRockMeasureResult
from generated.pb2.components.basestation import rock_measure_result_pb2
from roverlink.runtime.core.handler import Handler, Route


class RockMeasureResultHandler(
    Handler[
        rock_measure_result_pb2.BasestationRockMeasureResult,
        BasestationRockMeasureResult,
    ]
):
    """The measured size of a rock.

    Number 20 of the envelope, from the topic rock_measure_result to the peer
    basestation.
    """

    route = Route(
        number=20,
        name="rock_measure_result",
        topic="rock_measure_result",
        direction="ros_to_basestation",
    )
    payload_type = rock_measure_result_pb2.BasestationRockMeasureResult
    message_type = BasestationRockMeasureResult

    @staticmethod
    def to_ros(
        payload: rock_measure_result_pb2.BasestationRockMeasureResult,
    ) -> BasestationRockMeasureResult:
        """Convert BasestationRockMeasureResult to comms/msg/BasestationRockMeasureResult."""
        return BasestationRockMeasureResult(
            length_cm=payload.length_cm,
            width_cm=payload.width_cm,
            failure=payload.failure,
            length_sigma_cm=payload.length_sigma_cm,
            width_sigma_cm=payload.width_sigma_cm,
        )

    @staticmethod
    def from_ros(
        message: BasestationRockMeasureResult,
    ) -> rock_measure_result_pb2.BasestationRockMeasureResult:
        """Convert comms/msg/BasestationRockMeasureResult to BasestationRockMeasureResult."""
        return rock_measure_result_pb2.BasestationRockMeasureResult(
            length_cm=message.length_cm,
            width_cm=message.width_cm,
            failure=message.failure,
            length_sigma_cm=message.length_sigma_cm,
            width_sigma_cm=message.width_sigma_cm,
        )
