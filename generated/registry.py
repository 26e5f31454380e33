# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""Every row's handler, with the envelope they travel in."""

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
from generated.pb2.components.common import envelope_pb2
from runtime.registry import Peer, Registry

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
    fingerprint="94b070ecfffe4a4eaf7516a1e80177b1f27c0d0ba5a8848a61d7ab04851e305f",
    retired={},
)
