"""Units of fields in standard messages, and fields in which zero has a special meaning.

The sources are the comments in the .msg files of common_interfaces, which are the same in Humble and Jazzy. If these do
not give a unit, it comes from REP 103 (SI units, radians) or REP 145 (IMU drivers). The path of a field that contains a
message stands for all fields inside the message.
"""

from __future__ import annotations

from roverlink.generator.ir.interfaces import Path

_GEOMETRY = {
    "geometry_msgs/msg/Accel": {"linear": "m/s^2", "angular": "rad/s^2"},
    "geometry_msgs/msg/Inertia": {
        "m": "kg",
        "com": "m",
        **dict.fromkeys(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), "kg m^2"),
    },
    "geometry_msgs/msg/Point": {"x": "m", "y": "m", "z": "m"},
    "geometry_msgs/msg/Point32": {"x": "m", "y": "m", "z": "m"},
    "geometry_msgs/msg/Pose2D": {"x": "m", "y": "m", "theta": "rad"},
    "geometry_msgs/msg/Quaternion": {"x": "1", "y": "1", "z": "1", "w": "1"},
    "geometry_msgs/msg/Transform": {"translation": "m"},
    "geometry_msgs/msg/Twist": {"linear": "m/s", "angular": "rad/s"},
    "geometry_msgs/msg/Wrench": {"force": "N", "torque": "N m"},
}
_SENSORS = {
    "sensor_msgs/msg/BatteryState": {
        "voltage": "V",
        "temperature": "degC",
        "current": "A",
        "charge": "Ah",
        "capacity": "Ah",
        "design_capacity": "Ah",
        "percentage": "1",
        "cell_voltage": "V",
        "cell_temperature": "degC",
    },
    "sensor_msgs/msg/FluidPressure": {"fluid_pressure": "Pa", "variance": "Pa^2"},
    "sensor_msgs/msg/Illuminance": {"illuminance": "lx", "variance": "lx^2"},
    "sensor_msgs/msg/Imu": {
        "orientation_covariance": "rad^2",
        "angular_velocity": "rad/s",
        "linear_acceleration": "m/s^2",
        "angular_velocity_covariance": "rad^2/s^2",
        "linear_acceleration_covariance": "m^2/s^4",
    },
    "sensor_msgs/msg/LaserScan": {
        "angle_min": "rad",
        "angle_max": "rad",
        "angle_increment": "rad",
        "time_increment": "s",
        "scan_time": "s",
        "range_min": "m",
        "range_max": "m",
        "ranges": "m",
    },
    "sensor_msgs/msg/MagneticField": {"magnetic_field": "T", "magnetic_field_covariance": "T^2"},
    "sensor_msgs/msg/NavSatFix": {
        "latitude": "deg",
        "longitude": "deg",
        "altitude": "m",
        "position_covariance": "m^2",
    },
    "sensor_msgs/msg/Range": {
        "field_of_view": "rad",
        "min_range": "m",
        "max_range": "m",
        "range": "m",
        "variance": "m^2",
    },
    "sensor_msgs/msg/RelativeHumidity": {"relative_humidity": "1", "variance": "1"},
    "sensor_msgs/msg/Temperature": {"temperature": "degC", "variance": "K^2"},
}
UNITS: dict[str, dict[str, str]] = {**_GEOMETRY, **_SENSORS}
"""Unit of each field with a known unit, as ``{full name of the message: {path of the field: unit}}``."""

ZERO_MEANS: dict[str, dict[str, str]] = {
    "sensor_msgs/msg/FluidPressure": {"variance": "unknown"},
    "sensor_msgs/msg/Illuminance": {"variance": "unknown"},
    "sensor_msgs/msg/Imu": {
        "orientation_covariance": "unknown",
        "angular_velocity_covariance": "unknown",
        "linear_acceleration_covariance": "unknown",
    },
    "sensor_msgs/msg/JointState": {
        "position": "unknown if empty",
        "velocity": "unknown if empty",
        "effort": "unknown if empty",
    },
    "sensor_msgs/msg/LaserScan": {"intensities": "none if empty"},
    "sensor_msgs/msg/MagneticField": {"magnetic_field_covariance": "unknown"},
    "sensor_msgs/msg/NavSatFix": {
        "position_covariance": "unknown, because the type is also 0",
        "position_covariance_type": "COVARIANCE_TYPE_UNKNOWN",
    },
    "sensor_msgs/msg/Range": {"variance": "unknown"},
    "sensor_msgs/msg/RelativeHumidity": {"variance": "unknown"},
    "sensor_msgs/msg/Temperature": {"variance": "unknown"},
    "sensor_msgs/msg/TimeReference": {"source": "not named if empty"},
}
"""Special meaning of zero (or of an empty list or text) in a field, by the full name of the message and the path.

Every other field must be filled or listed under `unset`, because subscribers would read zero as a measurement.
"""

ABSENT_WHERE_MINUS_ONE: dict[str, dict[str, str]] = {
    "sensor_msgs/msg/Imu": {
        "orientation": "orientation_covariance",
        "angular_velocity": "angular_velocity_covariance",
        "linear_acceleration": "linear_acceleration_covariance",
    },
}
"""Fields that count as not measured if the first element of another field is -1: ``{message: {path: other path}}``.

The comments of sensor_msgs/Imu define this for its covariances.
"""


def unit_of(holders: tuple[str, ...], path: Path) -> str:
    """Return the unit of the field at a path; empty if it is unknown.

    ``holders`` are the messages along the path, the outermost first. The outermost message that gives a unit decides:
    `Vector3` has no unit, but the `angular_velocity` of an `Imu` is in rad/s.
    """
    for depth, holder in enumerate(holders):
        known = UNITS.get(holder, {})
        for end in range(len(path), depth, -1):
            if unit := known.get(".".join(path[depth:end])):
                return unit
    return ""
