# Generated from mapping.yaml (row drive_progress) and components/driving_board/motor_periodic_progress.proto; do not edit.
# Regenerate with: roverlink generate
"""Fast serialization of DrivingBoardMotorPeriodicProgress as comms/msg/DrivingBoardMotorPeriodicProgress.

The registry uses this class; programs import `DriveProgressHandler`
from `generated.handlers.drive_progress`.
"""

from __future__ import annotations

from generated.handlers.drive_progress import DriveProgressHandler
from generated.messages import DrivingBoardMotorPeriodicProgress
from generated.pb2.components.driving_board import motor_periodic_progress_pb2
from roverlink.runtime.core import cdr

_LAYOUT = cdr.fixed_layout(DrivingBoardMotorPeriodicProgress)


class FastDriveProgressHandler(DriveProgressHandler):
    """DriveProgressHandler that converts a payload to a serialized ROS message in one step."""

    def _pack(
        self, payload: motor_periodic_progress_pb2.DrivingBoardMotorPeriodicProgress
    ) -> bytes:
        """Convert a payload to its ROS message, serialized as CDR."""
        return _LAYOUT.pack(
            cdr.LITTLE_ENDIAN,
            payload.distance_left,
        )
