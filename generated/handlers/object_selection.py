# Generated from mapping.yaml (row object_selection) and components/basestation/object_selection.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row object_selection: BasestationObjectSelection and comms/msg/BasestationObjectSelection."""

from __future__ import annotations

from generated.messages import BasestationObjectSelection
from generated.pb2.components.basestation import object_selection_pb2
from roverlink.runtime.core.handler import Handler, Route


class ObjectSelectionHandler(
    Handler[object_selection_pb2.BasestationObjectSelection, BasestationObjectSelection]
):
    """The object that the operator picked among the detected ones.

    Number 18 of the envelope, from the peer basestation to the topic object_selection.
    """

    route = Route(
        number=18,
        name="object_selection",
        topic="object_selection",
        direction="basestation_to_ros",
    )
    payload_type = object_selection_pb2.BasestationObjectSelection
    message_type = BasestationObjectSelection

    @staticmethod
    def to_ros(
        payload: object_selection_pb2.BasestationObjectSelection,
    ) -> BasestationObjectSelection:
        """Convert BasestationObjectSelection to comms/msg/BasestationObjectSelection."""
        return BasestationObjectSelection(
            object_id=payload.object_id,
        )

    @staticmethod
    def from_ros(
        message: BasestationObjectSelection,
    ) -> object_selection_pb2.BasestationObjectSelection:
        """Convert comms/msg/BasestationObjectSelection to BasestationObjectSelection."""
        return object_selection_pb2.BasestationObjectSelection(
            object_id=message.object_id,
        )
