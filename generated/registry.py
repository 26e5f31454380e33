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
    sources={
        "mapping.yaml": "aede65d1c5b37e2f",
        "proto/components/arm_board/motor_diagnostics.proto": "19b803bb1e53824a",
        "proto/components/arm_board/movement_control_in.proto": "23e5214de1ed622e",
        "proto/components/arm_board/movement_software_feedback.proto": "c7af4ff5cc87800c",
        "proto/components/arm_board/movement_software_target.proto": "79eeda9ba2c0a7e0",
        "proto/components/basestation/control_mode.proto": "6aae605e3a347208",
        "proto/components/basestation/detected_object.proto": "fc99c0a74cdd0615",
        "proto/components/basestation/object_selection.proto": "4decfa2e2ede6dc8",
        "proto/components/basestation/rock_measure_request.proto": "d3918aa6938a0497",
        "proto/components/basestation/rock_measure_result.proto": "d5d3f3cea5554e9d",
        "proto/components/basestation/rover_localization.proto": "97be11e410b4630c",
        "proto/components/common/motor.proto": "041946204287d910",
        "proto/components/driving_board/motor_diagnostics.proto": "8aa8b8a3bc8d26c0",
        "proto/components/driving_board/motor_msg.proto": "ba6274a3da64815e",
        "proto/components/driving_board/motor_periodic_progress.proto": "12322b811d20e252",
        "proto/components/sensor_board/diagnostics.proto": "bbf812151439ecf4",
        "proto/components/sensor_board/gps_sensor.proto": "ab24d85e2aa32873",
        "proto/components/sensor_board/imu_sensor.proto": "766dd0e4bf0a2731",
        "proto/components/sensor_board/load_cell.proto": "63323009523f2952",
        "proto/components/sensor_board/ph_sensor.proto": "1d7f6aeb26c5e5f3",
        "proto/components/sensor_board/pressure_sensor.proto": "d0b2c200ee40b97c",
        "proto/components/sensor_board/sensor.proto": "c4e9d44d72c8ceb9",
    },
)
