# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""Handlers and registry, compiled from mapping.yaml."""

from __future__ import annotations

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
    "GpsInfoHandler",
    "ImuInfoHandler",
    "LoadCellInfoHandler",
    "ObjectSelectionHandler",
    "PhInfoHandler",
    "PressureInfoHandler",
    "REGISTRY",
    "RockMeasureRequestHandler",
    "RockMeasureResultHandler",
    "RoverLocalizationHandler",
    "SensorDiagHandler",
]
