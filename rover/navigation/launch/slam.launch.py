"""Start the whole rover. `ros2 launch rtt_slam slam.launch.py --show-args` lists the arguments."""

# check-launch: complete

from pathlib import Path

from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import AnyLaunchDescriptionSource


def generate_launch_description() -> LaunchDescription:
    """Return what slam_launch.yaml starts; it has all arguments."""
    file = Path(__file__).with_name("slam_launch.yaml")
    return LaunchDescription([IncludeLaunchDescription(AnyLaunchDescriptionSource(str(file)))])
