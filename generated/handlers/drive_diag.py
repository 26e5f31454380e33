# Generated from mapping.yaml (row drive_diag) and components/driving_board/motor_diagnostics.proto; do not edit.
# Regenerate with: roverlink generate
"""drive_diag (8): DrivingBoardDiagnostics to comms/msg/DrivingBoardDiagnostics on drive_diag."""

from __future__ import annotations

from generated.conversions import motor_information
from generated.messages import DrivingBoardDiagnostics
from generated.pb2.components.driving_board import motor_diagnostics_pb2
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import Handler, Route

_CDR = cdr.fixed_layout(DrivingBoardDiagnostics)


class DriveDiagHandler(
    Handler[motor_diagnostics_pb2.DrivingBoardDiagnostics, DrivingBoardDiagnostics],
):
    """DrivingBoardDiagnostics to the topic drive_diag."""

    route = Route(
        number=8,
        name="drive_diag",
        topic="drive_diag",
        direction="hardware_to_ros",
        forward=("basestation",),
    )
    payload_type = motor_diagnostics_pb2.DrivingBoardDiagnostics
    message_type = DrivingBoardDiagnostics

    @staticmethod
    def to_ros(
        payload: motor_diagnostics_pb2.DrivingBoardDiagnostics,
    ) -> DrivingBoardDiagnostics:
        """The message that says what the payload says."""
        return DrivingBoardDiagnostics(
            state=payload.state,
            front_left_motor=motor_information.to_ros(payload.front_left_motor),
            middle_left_motor=motor_information.to_ros(payload.middle_left_motor),
            back_left_motor=motor_information.to_ros(payload.back_left_motor),
            front_right_motor=motor_information.to_ros(payload.front_right_motor),
            middle_right_motor=motor_information.to_ros(payload.middle_right_motor),
            back_right_motor=motor_information.to_ros(payload.back_right_motor),
            steering_front_left_motor=motor_information.to_ros(
                payload.steering_front_left_motor,
            ),
            steering_back_left_motor=motor_information.to_ros(
                payload.steering_back_left_motor,
            ),
            steering_front_right_motor=motor_information.to_ros(
                payload.steering_front_right_motor,
            ),
            steering_back_right_motor=motor_information.to_ros(
                payload.steering_back_right_motor,
            ),
        )

    @staticmethod
    def from_ros(
        message: DrivingBoardDiagnostics,
    ) -> motor_diagnostics_pb2.DrivingBoardDiagnostics:
        """The payload that says what the message says."""
        return motor_diagnostics_pb2.DrivingBoardDiagnostics(
            state=message.state,
            front_left_motor=motor_information.from_ros(message.front_left_motor),
            middle_left_motor=motor_information.from_ros(message.middle_left_motor),
            back_left_motor=motor_information.from_ros(message.back_left_motor),
            front_right_motor=motor_information.from_ros(message.front_right_motor),
            middle_right_motor=motor_information.from_ros(message.middle_right_motor),
            back_right_motor=motor_information.from_ros(message.back_right_motor),
            steering_front_left_motor=motor_information.from_ros(
                message.steering_front_left_motor,
            ),
            steering_back_left_motor=motor_information.from_ros(
                message.steering_back_left_motor,
            ),
            steering_front_right_motor=motor_information.from_ros(
                message.steering_front_right_motor,
            ),
            steering_back_right_motor=motor_information.from_ros(
                message.steering_back_right_motor,
            ),
        )

    def pack(self, payload: motor_diagnostics_pb2.DrivingBoardDiagnostics) -> bytes:
        """`to_ros` and its serialization in one step: the values in the order of the .msg."""
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
        return _CDR.pack(
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
