# Generated from mapping.yaml (row rock_measure_result) and components/basestation/rock_measure_result.proto; do not edit.
# Regenerate with: roverlink generate
"""rock_measure_result (20): BasestationRockMeasureResult from comms/msg/BasestationRockMeasureResult on rock_measure_result."""

from __future__ import annotations

from generated.messages import BasestationRockMeasureResult
from generated.pb2.components.basestation import rock_measure_result_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Handler, Route

_CDR = cdr.fixed_layout(BasestationRockMeasureResult)


class RockMeasureResultHandler(
    Handler[
        rock_measure_result_pb2.BasestationRockMeasureResult,
        BasestationRockMeasureResult,
    ],
):
    """BasestationRockMeasureResult from the topic rock_measure_result."""

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
        """The message that says what the payload says."""
        return BasestationRockMeasureResult(
            length_cm=payload.length_cm,
            width_cm=payload.width_cm,
        )

    @staticmethod
    def from_ros(
        message: BasestationRockMeasureResult,
    ) -> rock_measure_result_pb2.BasestationRockMeasureResult:
        """The payload that says what the message says."""
        return rock_measure_result_pb2.BasestationRockMeasureResult(
            length_cm=message.length_cm,
            width_cm=message.width_cm,
        )

    def pack(
        self,
        payload: rock_measure_result_pb2.BasestationRockMeasureResult,
    ) -> bytes:
        """`to_ros` and its serialization in one step: the values in the order of the .msg."""
        return _CDR.pack(cdr.LITTLE_ENDIAN, payload.length_cm, payload.width_cm)
