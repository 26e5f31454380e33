"""Models of the sensor board's sensors: an IMU and a GPS receiver, both with noise. Units are those of SI."""

from __future__ import annotations

import math
import random
from dataclasses import dataclass, field

from roverkit.driving.arcs import PlanarPose
from roverkit.driving.geodesy import Datum

_GRAVITY = 9.80665
Vector = tuple[float, float, float]
"""Vector in the axes of base_link: x forward, y left, z up."""


@dataclass(frozen=True, slots=True)
class ImuSettings:
    """Noise of an IMU, and the Earth's magnetic field. The defaults are those of small MEMS sensors."""

    gyro_noise: float = 2.6e-4
    """Density of the noise of the angular velocity, in rad/s per square root of Hz (0.015 deg/s)."""
    gyro_bias: float = 5e-3
    """Standard deviation of the bias of the angular velocity at the start, in rad/s."""
    gyro_bias_walk: float = 5e-6
    """Random walk of this bias, in rad/s per square root of a second."""
    gyro_scale: float = 3e-3
    """Standard deviation of the relative error of the angular velocity, which stays the same."""
    acceleration_noise: float = 0.02
    """Standard deviation of a reading of the acceleration, in m/s^2."""
    acceleration_bias: float = 0.05
    """Standard deviation of the bias of the acceleration, in m/s^2."""
    field_noise: float = 0.5e-6
    """Standard deviation of a reading of the magnetic field, in T."""
    field_north: float = 20e-6
    """Horizontal part of the Earth's magnetic field, in T; the map's y axis points to magnetic north."""
    field_down: float = 44e-6
    """Vertical part of the field, in T."""


@dataclass(frozen=True, slots=True)
class GpsSettings:
    """Place and noise of a GPS receiver."""

    datum: Datum = field(default_factory=lambda: Datum(50.0647, 19.945, 219.0))
    """Origin of the map; the x axis of the map points to the east."""
    deviation: float = 0.6
    """Standard deviation of the position to the east and to the north, in metres."""
    altitude_deviation: float = 1.2
    """Standard deviation of the altitude in metres."""
    hdop: float = 0.9
    vdop: float = 1.4
    satellites: int = 11


@dataclass(frozen=True, slots=True)
class Motion:
    """Motion of the rover that an IMU measures: SI units, yaw counterclockwise from the east."""

    yaw: float
    yaw_rate: float
    speed: float
    acceleration: float


@dataclass(frozen=True, slots=True)
class ImuReading:
    """Measurement of an IMU."""

    at: int
    """Time in nanoseconds since the start of the model."""
    angular_velocity: Vector
    """Angular velocity in rad/s."""
    linear_acceleration: Vector
    """Specific force in m/s^2: an IMU at rest measures gravity upwards (REP 145)."""
    magnetic_field: Vector
    """Magnetic field in T."""


@dataclass(frozen=True, slots=True)
class GpsFix:
    """Measurement of a GPS receiver."""

    at: int
    """Time in nanoseconds since the start of the model."""
    latitude: float
    """Latitude in degrees."""
    longitude: float
    """Longitude in degrees."""
    altitude: float
    """Altitude in metres above the ellipsoid."""
    speed: float
    """Speed over ground in m/s."""
    heading: float
    """Course over ground in degrees, clockwise from north."""
    hdop: float
    vdop: float
    satellites: int


class Imu:
    """IMU with noise, and with a bias that changes slowly."""

    def __init__(self, generator: random.Random, settings: ImuSettings, scale: float) -> None:
        """``scale`` is the error of the gyroscope's scale in its standard deviation."""
        self._generator, self._settings = generator, settings
        self._gyro_bias = self._vector(settings.gyro_bias)
        self._gyro_scale = 1 + scale * settings.gyro_scale
        self._acceleration_bias = self._vector(settings.acceleration_bias)

    def reading(self, now: int, motion: Motion, period: float) -> ImuReading:
        """Measure a motion; ``period`` is the time in seconds since the last reading."""
        settings = self._settings
        self._gyro_bias = _sum(self._gyro_bias, self._vector(settings.gyro_bias_walk * math.sqrt(period)))
        cosine, sine = math.cos(motion.yaw), math.sin(motion.yaw)
        return ImuReading(
            now,
            _sum(
                (0, 0, motion.yaw_rate * self._gyro_scale),
                self._gyro_bias,
                self._vector(settings.gyro_noise / math.sqrt(period)),
            ),
            _sum(
                (motion.acceleration, motion.speed * motion.yaw_rate, _GRAVITY),
                self._acceleration_bias,
                self._vector(settings.acceleration_noise),
            ),
            _sum(
                (settings.field_north * sine, settings.field_north * cosine, -settings.field_down),
                self._vector(settings.field_noise),
            ),
        )

    def _vector(self, deviation: float) -> Vector:
        x, y, z = (self._generator.gauss(0, deviation) for _ in range(3))
        return x, y, z


class GpsReceiver:
    """GPS receiver at the origin of base_link, with independent noise of each fix."""

    def __init__(self, generator: random.Random, settings: GpsSettings) -> None:
        self._generator, self._settings = generator, settings

    def fix(self, now: int, pose: PlanarPose, speed: float) -> GpsFix:
        """Measure a pose in the map, and the speed along its x axis in m/s."""
        settings, gauss = self._settings, self._generator.gauss
        x, y = pose.x + gauss(0, settings.deviation), pose.y + gauss(0, settings.deviation)
        latitude, longitude = settings.datum.geodetic(x, y)
        course = 90 - math.degrees(pose.yaw) + (180 if speed < 0 else 0)
        return GpsFix(
            now,
            latitude,
            longitude,
            settings.datum.altitude + gauss(0, settings.altitude_deviation),
            abs(speed),
            course % 360,
            settings.hdop,
            settings.vdop,
            settings.satellites,
        )


def _sum(*vectors: Vector) -> Vector:
    x, y, z = (math.fsum(parts) for parts in zip(*vectors))
    return x, y, z
