# Generated from mapping.yaml (row drive_diag) and components/driving_board/motor_diagnostics.proto; do not edit.
# Regenerate with: roverlink generate
"""Fast serialization of DrivingBoardDiagnostics as comms/msg/DrivingBoardDiagnostics.

The registry uses this class; programs import `DriveDiagHandler`
from `generated.handlers.drive_diag`.
"""

from __future__ import annotations

from generated.handlers.drive_diag import DriveDiagHandler
from generated.messages import DrivingBoardDiagnostics
from generated.pb2.components.driving_board import motor_diagnostics_pb2
from roverlink.runtime.core import cdr

_LAYOUT = cdr.fixed_layout(DrivingBoardDiagnostics)


class FastDriveDiagHandler(DriveDiagHandler):
    """DriveDiagHandler that converts a payload to a serialized ROS message in one step."""

    def _pack(self, payload: motor_diagnostics_pb2.DrivingBoardDiagnostics) -> bytes:
        """Convert a payload to its ROS message, serialized as CDR."""
        front_left_motor = payload.front_left_motor
        middle_left_motor = payload.middle_left_motor
        back_left_motor = payload.back_left_motor
        front_right_motor = payload.front_right_motor
        middle_right_motor = payload.middle_right_motor
        back_right_motor = payload.back_right_motor
        steering_front_left_motor = payload.steering_front_left_motor
        steering_back_left_motor = payload.steering_back_left_motor
        steering_front_right_motor = payload.steering_front_right_motor
        steering_back_right_motor = payload.steering_back_right_motor
        return _LAYOUT.pack(
            cdr.LITTLE_ENDIAN,
            payload.state,
            front_left_motor.state,
            front_left_motor.motor_id,
            front_left_motor.rpm,
            front_left_motor.voltage,
            front_left_motor.encoder_angle,
            middle_left_motor.state,
            middle_left_motor.motor_id,
            middle_left_motor.rpm,
            middle_left_motor.voltage,
            middle_left_motor.encoder_angle,
            back_left_motor.state,
            back_left_motor.motor_id,
            back_left_motor.rpm,
            back_left_motor.voltage,
            back_left_motor.encoder_angle,
            front_right_motor.state,
            front_right_motor.motor_id,
            front_right_motor.rpm,
            front_right_motor.voltage,
            front_right_motor.encoder_angle,
            middle_right_motor.state,
            middle_right_motor.motor_id,
            middle_right_motor.rpm,
            middle_right_motor.voltage,
            middle_right_motor.encoder_angle,
            back_right_motor.state,
            back_right_motor.motor_id,
            back_right_motor.rpm,
            back_right_motor.voltage,
            back_right_motor.encoder_angle,
            steering_front_left_motor.state,
            steering_front_left_motor.motor_id,
            steering_front_left_motor.rpm,
            steering_front_left_motor.voltage,
            steering_front_left_motor.encoder_angle,
            steering_back_left_motor.state,
            steering_back_left_motor.motor_id,
            steering_back_left_motor.rpm,
            steering_back_left_motor.voltage,
            steering_back_left_motor.encoder_angle,
            steering_front_right_motor.state,
            steering_front_right_motor.motor_id,
            steering_front_right_motor.rpm,
            steering_front_right_motor.voltage,
            steering_front_right_motor.encoder_angle,
            steering_back_right_motor.state,
            steering_back_right_motor.motor_id,
            steering_back_right_motor.rpm,
            steering_back_right_motor.voltage,
            steering_back_right_motor.encoder_angle,
        )
