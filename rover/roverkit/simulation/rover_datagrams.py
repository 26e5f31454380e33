"""Datagrams of a simulated rover: its measurements in the units of the table, and the commands that it receives."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from google.protobuf.message import Message as ProtoMessage
from roverkit.driving.board_commands import NUMBER, BoardCommand
from roverkit.driving.drive_declaration import COMMAND
from roverkit.odometry.odometry_declaration import DIAGNOSTICS, ODOMETER, PROGRESS, WHEELS
from roverkit.simulation.rover_model import Measurement, MotorReport, ProgressReport
from roverkit.simulation.rover_sensors import ImuReading

from roverlink.runtime import Registry
from roverlink.runtime.core.registry import AnyHandler

IMU, GPS = "imu_info", "gps_info"
"""Names of the rows in mapping.yaml; `odometry_declaration` has those of the driving board."""
_STEERING = {
    f"steering_{end}_{side}_motor": sign for end, sign in (("front", 1), ("back", -1)) for side in ("left", "right")
}
_ARRAYS = ("accel", "gyro", "mag")
_AXES = [f"{name}_{axis}" for name in _ARRAYS for axis in "xyz"]
_MICROTESLA = 1e6
_VOLTAGE = 24.0
_OPERATING = 1  # of SensorState
_FIX = 1  # of GPSFixQuality: GPS_FIX


class RoverDatagrams:
    """Conversion between the measurements and commands of a `RoverModel` and the datagrams of the table's rows."""

    def __init__(self, registry: Registry) -> None:
        """Find the rows. Raises `SetupError` if one is missing, or lacks a field."""
        self._registry = registry
        PROGRESS.of(registry)
        registry.row(DIAGNOSTICS.row, ("state", *WHEELS, *_STEERING), inbound=True)
        registry.row(IMU, _AXES, inbound=True)
        registry.row(GPS, ("latitude", "longitude", "altitude"), inbound=True)
        self._command = registry.row(COMMAND.row, COMMAND.fields, inbound=False).route

    @property
    def peer(self) -> str:
        """Name of the peer that the boards are."""
        return self._command.peer

    def command(self, number: int, payload: ProtoMessage) -> BoardCommand | None:
        """Return the command in a payload with a number; None if it is another payload."""
        if number != self._command.number:
            return None
        values: Any = payload
        return BoardCommand(values.distance_to_go, values.turning_radius, getattr(values, NUMBER, 0))

    def datagram(self, measured: Measurement) -> tuple[str, bytes]:
        """Return the name of a measurement's row, and the serialized envelope."""
        name, values = _values(measured)
        handler: AnyHandler = self._registry.by_name[name]
        known = handler.payload_type.DESCRIPTOR.fields_by_name
        payload = handler.payload_type(**{field: value for field, value in values.items() if field in known})
        return name, self._registry.datagram(name, payload)


def _values(measured: Measurement) -> tuple[str, Mapping[str, Any]]:
    """Return the row of a measurement, and the values of the payload's fields.

    The units are those that mapping.yaml states: m/s^2, deg/s and uT for the IMU.
    """
    if isinstance(measured, ProgressReport):
        report = {ODOMETER: measured.odometer, NUMBER: measured.command_number}
        return PROGRESS.row, {"distance_left": measured.distance_left, **report}
    if isinstance(measured, MotorReport):
        return DIAGNOSTICS.row, _diagnostics(measured)
    if isinstance(measured, ImuReading):
        gyro = [math.degrees(rate) for rate in measured.angular_velocity]
        field = [_MICROTESLA * value for value in measured.magnetic_field]
        values = dict(zip(_AXES, [*measured.linear_acceleration, *gyro, *field]))
        return IMU, {**values, "is_calibrated": True, "state": _OPERATING}
    return GPS, {
        "latitude": measured.latitude,
        "longitude": measured.longitude,
        "altitude": measured.altitude,
        "speed": measured.speed,
        "heading": measured.heading,
        "hdop": measured.hdop,
        "vdop": measured.vdop,
        "satellites": measured.satellites,
        "fix_quality": _FIX,
        "state": _OPERATING,
    }


def _diagnostics(measured: MotorReport) -> Mapping[str, Any]:
    motors: dict[str, Any] = {"state": int(measured.state)}
    for number, name in enumerate(WHEELS, start=1):
        rpm = measured.left_rpm if "left" in name else measured.right_rpm
        motors[name] = {"state": int(measured.state), "motor_id": number, "rpm": rpm, "voltage": _VOLTAGE}
    for number, (name, sign) in enumerate(_STEERING.items(), start=len(WHEELS) + 1):
        angle = math.degrees(sign * measured.steering)
        motors[name] = {"motor_id": number, "voltage": _VOLTAGE, "encoder_angle": angle}
    return motors
