# Generated from mapping.yaml (row drive_motor) and components/driving_board/motor_msg.proto; do not edit.
# Regenerate with: roverlink generate
"""Fast serialization of DrivingBoardMotorMessage as comms/msg/DrivingBoardMotorMessage.

The registry uses this class; programs import `DriveMotorHandler`
from `generated.handlers.drive_motor`.
"""

from __future__ import annotations

from generated.handlers.drive_motor import DriveMotorHandler
from generated.messages import DrivingBoardMotorMessage
from generated.pb2.components.driving_board import motor_msg_pb2
from roverlink.runtime.core import cdr

_LAYOUT = cdr.fixed_layout(DrivingBoardMotorMessage)


class FastDriveMotorHandler(DriveMotorHandler):
    """DriveMotorHandler that converts a payload to a serialized ROS message in one step."""

    def _pack(self, payload: motor_msg_pb2.DrivingBoardMotorMessage) -> bytes:
        """Convert a payload to its ROS message, serialized as CDR."""
        return _LAYOUT.pack(
            cdr.LITTLE_ENDIAN,
            payload.distance_to_go,
            payload.turning_radius,
        )
