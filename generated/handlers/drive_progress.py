# Generated from mapping.yaml (row drive_progress) and components/driving_board/motor_periodic_progress.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row drive_progress: DrivingBoardMotorPeriodicProgress and comms/msg/DrivingBoardMotorPeriodicProgress."""

from __future__ import annotations

from generated.messages import DrivingBoardMotorPeriodicProgress
from generated.pb2.components.driving_board import motor_periodic_progress_pb2
from roverlink.runtime.core.handler import Handler, Route


class DriveProgressHandler(
    Handler[
        motor_periodic_progress_pb2.DrivingBoardMotorPeriodicProgress,
        DrivingBoardMotorPeriodicProgress,
    ]
):
    """Distance left on the current drive command.

    Number 10 of the envelope, from the peer hardware to the topic drive_progress.
    """

    route = Route(
        number=10,
        name="drive_progress",
        topic="drive_progress",
        direction="hardware_to_ros",
        forward=("basestation",),
        board="DrivingBoard",
    )
    payload_type = motor_periodic_progress_pb2.DrivingBoardMotorPeriodicProgress
    message_type = DrivingBoardMotorPeriodicProgress

    @staticmethod
    def to_ros(
        payload: motor_periodic_progress_pb2.DrivingBoardMotorPeriodicProgress,
    ) -> DrivingBoardMotorPeriodicProgress:
        """Convert DrivingBoardMotorPeriodicProgress to comms/msg/DrivingBoardMotorPeriodicProgress."""
        return DrivingBoardMotorPeriodicProgress(
            distance_left=payload.distance_left,
        )

    @staticmethod
    def from_ros(
        message: DrivingBoardMotorPeriodicProgress,
    ) -> motor_periodic_progress_pb2.DrivingBoardMotorPeriodicProgress:
        """Convert comms/msg/DrivingBoardMotorPeriodicProgress to DrivingBoardMotorPeriodicProgress."""
        return motor_periodic_progress_pb2.DrivingBoardMotorPeriodicProgress(
            distance_left=message.distance_left,
        )
