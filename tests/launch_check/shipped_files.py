"""The parameter files of this repository, each with a launch file that uses it."""

from __future__ import annotations

LAUNCH_FILES = {
    "navigation/config/camera_realsense.yaml": "navigation/launch/camera_launch.yaml",
    "navigation/config/drive.yaml": "navigation/launch/navigation_launch.yaml",
    "navigation/config/ekf.yaml": "navigation/launch/localization_launch.yaml",
    "navigation/config/imu_filter.yaml": "navigation/launch/rtabmap_launch.yaml",
    "navigation/config/navigation.yaml": "navigation/launch/navigation_launch.yaml",
    "navigation/config/rtabmap.yaml": "navigation/launch/rtabmap_launch.yaml",
    "navigation/config/rtabmap_landmarks.yaml": "navigation/launch/rtabmap_launch.yaml",
    "navigation/config/rtabmap_slam.yaml": "navigation/launch/rtabmap_launch.yaml",
    "generated/ros/comms/config/udp.yaml": "generated/ros/comms/launch/comms_launch.yaml",
}
