# Generated from mapping.yaml (row drive_progress) and components/driving_board/motor_periodic_progress.proto; do not edit.
# Regenerate with: roverlink generate
"""drive_progress (10): DrivingBoardMotorPeriodicProgress to comms/msg/DrivingBoardMotorPeriodicProgress on drive_progress."""

from __future__ import annotations

from generated.messages import DrivingBoardMotorPeriodicProgress
from generated.pb2.components.driving_board import motor_periodic_progress_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Handler, Route

_CDR = cdr.fixed_layout(DrivingBoardMotorPeriodicProgress)


class DriveProgressHandler(
    Handler[
        motor_periodic_progress_pb2.DrivingBoardMotorPeriodicProgress,
        DrivingBoardMotorPeriodicProgress,
    ],
):
    """DrivingBoardMotorPeriodicProgress to the topic drive_progress."""

    route = Route(
        number=10,
        name="drive_progress",
        topic="drive_progress",
        direction="hardware_to_ros",
        forward=("basestation",),
    )
    payload_type = motor_periodic_progress_pb2.DrivingBoardMotorPeriodicProgress
    message_type = DrivingBoardMotorPeriodicProgress

    @staticmethod
    def to_ros(
        payload: motor_periodic_progress_pb2.DrivingBoardMotorPeriodicProgress,
    ) -> DrivingBoardMotorPeriodicProgress:
        """The message that says what the payload says."""
        return DrivingBoardMotorPeriodicProgress(distance_left=payload.distance_left)

    @staticmethod
    def from_ros(
        message: DrivingBoardMotorPeriodicProgress,
    ) -> motor_periodic_progress_pb2.DrivingBoardMotorPeriodicProgress:
        """The payload that says what the message says."""
        return motor_periodic_progress_pb2.DrivingBoardMotorPeriodicProgress(
            distance_left=message.distance_left,
        )

    def pack(
        self,
        payload: motor_periodic_progress_pb2.DrivingBoardMotorPeriodicProgress,
    ) -> bytes:
        """`to_ros` and its serialization in one step: the values in the order of the .msg."""
        return _CDR.pack(cdr.LITTLE_ENDIAN, payload.distance_left)
