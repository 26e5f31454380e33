# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""The feeds: further topics of the rows, with messages of the common interfaces."""

from __future__ import annotations

from generated.feeds.gps_info_gps_fix import GpsInfoGpsFixFeed
from generated.feeds.imu_info_imu_data_raw import ImuInfoImuDataRawFeed
from generated.feeds.imu_info_imu_mag import ImuInfoImuMagFeed
from generated.feeds.ph_info_ph_temperature import PhInfoPhTemperatureFeed
from generated.feeds.pressure_info_pressure_fluid_pressure import (
    PressureInfoPressureFluidPressureFeed,
)
from generated.feeds.pressure_info_pressure_temperature import (
    PressureInfoPressureTemperatureFeed,
)

__all__ = [
    "GpsInfoGpsFixFeed",
    "ImuInfoImuDataRawFeed",
    "ImuInfoImuMagFeed",
    "PhInfoPhTemperatureFeed",
    "PressureInfoPressureFluidPressureFeed",
    "PressureInfoPressureTemperatureFeed",
]
