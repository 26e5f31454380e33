# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""Extra topics of the rows, with standard messages: one handler class for each topic."""

from __future__ import annotations

from generated.extra_topics.gps_fix import GpsFixTopic
from generated.extra_topics.imu_data_raw import ImuDataRawTopic
from generated.extra_topics.imu_mag import ImuMagTopic
from generated.extra_topics.odometry_global import OdometryGlobalTopic
from generated.extra_topics.ph_temperature import PhTemperatureTopic
from generated.extra_topics.pressure_fluid_pressure import PressureFluidPressureTopic
from generated.extra_topics.pressure_temperature import PressureTemperatureTopic

__all__ = [
    "GpsFixTopic",
    "ImuDataRawTopic",
    "ImuMagTopic",
    "OdometryGlobalTopic",
    "PhTemperatureTopic",
    "PressureFluidPressureTopic",
    "PressureTemperatureTopic",
]
