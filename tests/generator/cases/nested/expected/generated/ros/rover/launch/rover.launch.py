# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""Starts the bridge with the parameters in config/udp.yaml."""

from pathlib import Path

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess
from launch.substitutions import LaunchConfiguration

PARAMETERS = Path(__file__).parents[1] / "config" / "udp.yaml"


def generate_launch_description() -> LaunchDescription:
    """One process: `roverlink run`, which has to be on the PATH."""
    return LaunchDescription(
        [
            DeclareLaunchArgument("params_file", default_value=str(PARAMETERS)),
            ExecuteProcess(
                cmd=[
                    "roverlink",
                    "run",
                    "--ros-args",
                    "--params-file",
                    LaunchConfiguration("params_file"),
                ],
                output="screen",
            ),
        ]
    )
