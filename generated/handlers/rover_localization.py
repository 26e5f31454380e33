# Generated from mapping.yaml (row rover_localization) and components/basestation/rover_localization.proto; do not edit.
# Regenerate with: roverlink generate
"""rover_localization (21): BasestationRoverLocalization from comms/msg/BasestationRoverLocalization on rover_localization."""

from __future__ import annotations

from generated.messages import BasestationRoverLocalization
from generated.pb2.components.basestation import rover_localization_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Handler, Route

_CDR = cdr.fixed_layout(BasestationRoverLocalization)


class RoverLocalizationHandler(
    Handler[
        rover_localization_pb2.BasestationRoverLocalization,
        BasestationRoverLocalization,
    ],
):
    """BasestationRoverLocalization from the topic rover_localization."""

    route = Route(
        number=21,
        name="rover_localization",
        topic="rover_localization",
        direction="ros_to_basestation",
    )
    payload_type = rover_localization_pb2.BasestationRoverLocalization
    message_type = BasestationRoverLocalization

    @staticmethod
    def to_ros(
        payload: rover_localization_pb2.BasestationRoverLocalization,
    ) -> BasestationRoverLocalization:
        """The message that says what the payload says."""
        return BasestationRoverLocalization(x=payload.x, y=payload.y, z=payload.z)

    @staticmethod
    def from_ros(
        message: BasestationRoverLocalization,
    ) -> rover_localization_pb2.BasestationRoverLocalization:
        """The payload that says what the message says."""
        return rover_localization_pb2.BasestationRoverLocalization(
            x=message.x,
            y=message.y,
            z=message.z,
        )

    def pack(
        self,
        payload: rover_localization_pb2.BasestationRoverLocalization,
    ) -> bytes:
        """`to_ros` and its serialization in one step: the values in the order of the .msg."""
        return _CDR.pack(cdr.LITTLE_ENDIAN, payload.x, payload.y, payload.z)
