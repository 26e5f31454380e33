# Generated from mapping.yaml (row rover_localization) and components/basestation/rover_localization.proto; do not edit.
# Regenerate with: roverlink generate
"""Fast serialization of BasestationRoverLocalization as comms/msg/BasestationRoverLocalization.

The registry uses this class; programs import `RoverLocalizationHandler`
from `generated.handlers.rover_localization`.
"""

from __future__ import annotations

from generated.handlers.rover_localization import RoverLocalizationHandler
from generated.messages import BasestationRoverLocalization
from generated.pb2.components.basestation import rover_localization_pb2
from roverlink.runtime.core import cdr

_LAYOUT = cdr.fixed_layout(BasestationRoverLocalization)


class FastRoverLocalizationHandler(RoverLocalizationHandler):
    """RoverLocalizationHandler that converts a payload to a serialized ROS message in one step."""

    def _pack(
        self, payload: rover_localization_pb2.BasestationRoverLocalization
    ) -> bytes:
        """Convert a payload to its ROS message, serialized as CDR."""
        return _LAYOUT.pack(
            cdr.LITTLE_ENDIAN,
            payload.x,
            payload.y,
            payload.z,
        )
