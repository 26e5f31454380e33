# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""Registry: the envelope, the peers, and a handler for every row and every extra topic.

Where a message has a fixed size, its handler is the fast subclass in
`generated.serializers`.
"""

from __future__ import annotations

from generated.pb2.components.common import envelope_pb2
from generated.serializers.arm_ctrl import FastArmCtrlHandler
from generated.serializers.arm_diag import FastArmDiagHandler
from generated.serializers.arm_feedback import FastArmFeedbackHandler
from generated.serializers.arm_obstructions import FastArmObstructionsHandler
from generated.serializers.arm_pos import FastArmPosHandler
from generated.serializers.arm_target import FastArmTargetHandler
from generated.serializers.control_mode import FastControlModeHandler
from generated.serializers.detected_object import FastDetectedObjectHandler
from generated.serializers.drive_diag import FastDriveDiagHandler
from generated.serializers.drive_motor import FastDriveMotorHandler
from generated.serializers.drive_progress import FastDriveProgressHandler
from generated.serializers.gps_fix_topic import FastGpsFixTopic
from generated.serializers.gps_info import FastGpsInfoHandler
from generated.serializers.imu_data_raw_topic import FastImuDataRawTopic
from generated.serializers.imu_info import FastImuInfoHandler
from generated.serializers.imu_mag_topic import FastImuMagTopic
from generated.serializers.load_cell_info import FastLoadCellInfoHandler
from generated.serializers.object_selection import FastObjectSelectionHandler
from generated.serializers.odometry_global_topic import FastOdometryGlobalTopic
from generated.serializers.ph_info import FastPhInfoHandler
from generated.serializers.ph_temperature_topic import FastPhTemperatureTopic
from generated.serializers.pressure_fluid_pressure_topic import (
    FastPressureFluidPressureTopic,
)
from generated.serializers.pressure_info import FastPressureInfoHandler
from generated.serializers.pressure_temperature_topic import (
    FastPressureTemperatureTopic,
)
from generated.serializers.rock_measure_request import FastRockMeasureRequestHandler
from generated.serializers.rock_measure_result import FastRockMeasureResultHandler
from generated.serializers.rover_localization import FastRoverLocalizationHandler
from generated.serializers.sensor_diag import FastSensorDiagHandler
from roverlink.runtime.core.registry import Peer, Registry

REGISTRY = Registry(
    package="comms",
    envelope=envelope_pb2.PBEnvelope,
    oneof="payload",
    peers=(
        Peer(
            name="basestation",
            port_parameter="dst_a_port",
            port=6000,
        ),
        Peer(
            name="hardware",
            port_parameter="dst_b_port",
            port=6001,
            max_size=1472,
        ),
    ),
    handlers=(
        FastPhInfoHandler(),
        FastArmCtrlHandler(),
        FastArmDiagHandler(),
        FastArmFeedbackHandler(),
        FastArmPosHandler(),
        FastArmTargetHandler(),
        FastArmObstructionsHandler(),
        FastDriveDiagHandler(),
        FastDriveMotorHandler(),
        FastDriveProgressHandler(),
        FastSensorDiagHandler(),
        FastGpsInfoHandler(),
        FastImuInfoHandler(),
        FastLoadCellInfoHandler(),
        FastPressureInfoHandler(),
        FastControlModeHandler(),
        FastDetectedObjectHandler(),
        FastObjectSelectionHandler(),
        FastRockMeasureRequestHandler(),
        FastRockMeasureResultHandler(),
        FastRoverLocalizationHandler(),
    ),
    extra_topics=(
        FastPhTemperatureTopic(),
        FastGpsFixTopic(),
        FastImuDataRawTopic(),
        FastImuMagTopic(),
        FastPressureFluidPressureTopic(),
        FastPressureTemperatureTopic(),
        FastOdometryGlobalTopic(),
    ),
    fingerprint="504e342d7638838b4c5ece4f5a036b1f3dac5b20c12f4ba777f14a3acdd16ea2",
)
