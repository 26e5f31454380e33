# Generated from mapping.yaml (row object_selection) and components/basestation/object_selection.proto; do not edit.
# Regenerate with: roverlink generate
"""object_selection (18): BasestationObjectSelection to comms/msg/BasestationObjectSelection on object_selection."""

from __future__ import annotations

from generated.messages import BasestationObjectSelection
from generated.pb2.components.basestation import object_selection_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Handler, Route

_CDR = cdr.fixed_layout(BasestationObjectSelection)


class ObjectSelectionHandler(
    Handler[
        object_selection_pb2.BasestationObjectSelection,
        BasestationObjectSelection,
    ],
):
    """BasestationObjectSelection to the topic object_selection."""

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
        """The message that says what the payload says."""
        return BasestationObjectSelection(object_id=payload.object_id)

    @staticmethod
    def from_ros(
        message: BasestationObjectSelection,
    ) -> object_selection_pb2.BasestationObjectSelection:
        """The payload that says what the message says."""
        return object_selection_pb2.BasestationObjectSelection(
            object_id=message.object_id,
        )

    def pack(self, payload: object_selection_pb2.BasestationObjectSelection) -> bytes:
        """`to_ros` and its serialization in one step: the values in the order of the .msg."""
        return _CDR.pack(cdr.LITTLE_ENDIAN, payload.object_id)
