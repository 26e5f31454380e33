# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""Start the bridge with the parameters in config/udp.yaml."""

from pathlib import Path

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

PARAMETERS = Path(__file__).parents[1] / "config" / "udp.yaml"


def generate_launch_description() -> LaunchDescription:
    """Return the node; its program uses the roverlink of the current Python environment."""
    return LaunchDescription(
        [
            DeclareLaunchArgument("params_file", default_value=str(PARAMETERS)),
            Node(
                package="comms",
                executable="comms_node",
                parameters=[LaunchConfiguration("params_file")],
                output="screen",
            ),
        ]
    )
