"""The parameter files of this repository, each with a launch file that uses it."""

from __future__ import annotations

LAUNCH_FILES = {
    "rover/navigation/config/camera_realsense.yaml": "rover/navigation/launch/camera_launch.yaml",
    "rover/navigation/config/drive.yaml": "rover/navigation/launch/navigation_launch.yaml",
    "rover/navigation/config/ekf.yaml": "rover/navigation/launch/localization_launch.yaml",
    "rover/navigation/config/imu_filter.yaml": "rover/navigation/launch/rtabmap_launch.yaml",
    "rover/navigation/config/navigation.yaml": "rover/navigation/launch/navigation_launch.yaml",
    "rover/navigation/config/obstacles.yaml": "rover/navigation/launch/navigation_launch.yaml",
    "rover/navigation/config/rtabmap.yaml": "rover/navigation/launch/rtabmap_launch.yaml",
    "rover/navigation/config/rtabmap_landmarks.yaml": "rover/navigation/launch/rtabmap_launch.yaml",
    "rover/navigation/config/rtabmap_slam.yaml": "rover/navigation/launch/rtabmap_launch.yaml",
    "generated/ros/comms/config/udp.yaml": "generated/ros/comms/launch/comms_launch.yaml",
}
