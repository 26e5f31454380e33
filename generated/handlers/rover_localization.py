# Generated from mapping.yaml (row rover_localization) and components/basestation/rover_localization.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row rover_localization: BasestationRoverLocalization and comms/msg/BasestationRoverLocalization."""

from __future__ import annotations

from generated.messages import BasestationRoverLocalization
from generated.pb2.components.basestation import rover_localization_pb2
from roverlink.runtime.core.handler import Handler, Route


class RoverLocalizationHandler(
    Handler[
        rover_localization_pb2.BasestationRoverLocalization,
        BasestationRoverLocalization,
    ]
):
    """Position of the rover on the field.

    Number 21 of the envelope, from the topic rover_localization to the peer
    basestation.
    """

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
        """Convert BasestationRoverLocalization to comms/msg/BasestationRoverLocalization."""
        return BasestationRoverLocalization(
            x=payload.x,
            y=payload.y,
            z=payload.z,
        )

    @staticmethod
    def from_ros(
        message: BasestationRoverLocalization,
    ) -> rover_localization_pb2.BasestationRoverLocalization:
        """Convert comms/msg/BasestationRoverLocalization to BasestationRoverLocalization."""
        return rover_localization_pb2.BasestationRoverLocalization(
            x=message.x,
            y=message.y,
            z=message.z,
        )
