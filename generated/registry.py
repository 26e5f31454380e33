# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""Every row's handler, with the envelope they travel in."""

from __future__ import annotations

from generated.feeds import (
    GpsInfoGpsFixFeed,
    ImuInfoImuDataRawFeed,
    ImuInfoImuMagFeed,
    PhInfoPhTemperatureFeed,
    PressureInfoPressureFluidPressureFeed,
    PressureInfoPressureTemperatureFeed,
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
from generated.pb2.components.common import envelope_pb2
from roverlink.runtime.core.registry import Peer, Registry

REGISTRY = Registry(
    package="comms",
    envelope=envelope_pb2.PBEnvelope,
    oneof="payload",
    peers=(
        Peer(name="basestation", port_parameter="dst_a_port", port=6000),
        Peer(name="hardware", port_parameter="dst_b_port", port=6001),
    ),
    handlers=(
        PhInfoHandler(),
        ArmCtrlHandler(),
        ArmDiagHandler(),
        ArmFeedbackHandler(),
        ArmPosHandler(),
        ArmTargetHandler(),
        ArmObstructionsHandler(),
        DriveDiagHandler(),
        DriveMotorHandler(),
        DriveProgressHandler(),
        SensorDiagHandler(),
        GpsInfoHandler(),
        ImuInfoHandler(),
        LoadCellInfoHandler(),
        PressureInfoHandler(),
        ControlModeHandler(),
        DetectedObjectHandler(),
        ObjectSelectionHandler(),
        RockMeasureRequestHandler(),
        RockMeasureResultHandler(),
        RoverLocalizationHandler(),
    ),
    feeds=(
        PhInfoPhTemperatureFeed(),
        GpsInfoGpsFixFeed(),
        ImuInfoImuDataRawFeed(),
        ImuInfoImuMagFeed(),
        PressureInfoPressureFluidPressureFeed(),
        PressureInfoPressureTemperatureFeed(),
    ),
    fingerprint="fa57807d3fe8a6dff40e8a63d2c93f36cde3e03e659ba5c7b2403284da2b3093",
    retired={},
)
