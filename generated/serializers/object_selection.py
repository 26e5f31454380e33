# Generated from mapping.yaml (row object_selection) and components/basestation/object_selection.proto; do not edit.
# Regenerate with: roverlink generate
"""Fast serialization of BasestationObjectSelection as comms/msg/BasestationObjectSelection.

The registry uses this class; programs import `ObjectSelectionHandler`
from `generated.handlers.object_selection`.
"""

from __future__ import annotations

from generated.handlers.object_selection import ObjectSelectionHandler
from generated.messages import BasestationObjectSelection
from generated.pb2.components.basestation import object_selection_pb2
from roverlink.runtime.core import cdr

_LAYOUT = cdr.fixed_layout(BasestationObjectSelection)


class FastObjectSelectionHandler(ObjectSelectionHandler):
    """ObjectSelectionHandler that converts a payload to a serialized ROS message in one step."""

    def _pack(self, payload: object_selection_pb2.BasestationObjectSelection) -> bytes:
        """Convert a payload to its ROS message, serialized as CDR."""
        return _LAYOUT.pack(
            cdr.LITTLE_ENDIAN,
            payload.object_id,
        )
