# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""The registry and the handlers of rows and extra topics, compiled from mapping.yaml."""

from __future__ import annotations

from generated.extra_topics import (
    GpsFixTopic,
    ImuDataRawTopic,
    ImuMagTopic,
    OdometryGlobalTopic,
    PhTemperatureTopic,
    PressureFluidPressureTopic,
    PressureTemperatureTopic,
)
from generated.handlers import (
    ArmCtrlHandler,
    ArmDiagHandler,
    ArmFeedbackHandler,
    ArmObstructionsHandler,
    ArmPosHandler,
    ArmTargetHandler,
    ControlModeHandler,
    DetectedObjectHandler,
    DriveDiagHandler,
    DriveMotorHandler,
    DriveProgressHandler,
    GpsInfoHandler,
    ImuInfoHandler,
    LoadCellInfoHandler,
    ObjectSelectionHandler,
    PhInfoHandler,
    PressureInfoHandler,
    RockMeasureRequestHandler,
    RockMeasureResultHandler,
    RoverLocalizationHandler,
    SensorDiagHandler,
)
from generated.registry import REGISTRY

__all__ = [
    "ArmCtrlHandler",
    "ArmDiagHandler",
    "ArmFeedbackHandler",
    "ArmObstructionsHandler",
    "ArmPosHandler",
    "ArmTargetHandler",
    "ControlModeHandler",
    "DetectedObjectHandler",
    "DriveDiagHandler",
    "DriveMotorHandler",
    "DriveProgressHandler",
    "GpsFixTopic",
    "GpsInfoHandler",
    "ImuDataRawTopic",
    "ImuInfoHandler",
    "ImuMagTopic",
    "LoadCellInfoHandler",
    "ObjectSelectionHandler",
    "OdometryGlobalTopic",
    "PhInfoHandler",
    "PhTemperatureTopic",
    "PressureFluidPressureTopic",
    "PressureInfoHandler",
    "PressureTemperatureTopic",
    "REGISTRY",
    "RockMeasureRequestHandler",
    "RockMeasureResultHandler",
    "RoverLocalizationHandler",
    "SensorDiagHandler",
]
