# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""Start the bridge. `ros2 launch comms comms.launch.py --show-args` lists the arguments."""

from pathlib import Path

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, GroupAction
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration, PythonExpression
from launch_ros.actions import Node, SetParameter

PARAMETERS = Path(__file__).parents[1] / "config" / "udp.yaml"


def generate_launch_description() -> LaunchDescription:
    """Return the node and its arguments; the program uses the roverlink of the current Python environment."""
    return LaunchDescription(
        [
            DeclareLaunchArgument(
                "middleware",
                default_value="auto",
                description="auto, dds, rclpy, zenoh or memory; `roverlink run --help` explains them",
            ),
            DeclareLaunchArgument(
                "namespace",
                default_value="",
                description="ROS 2 namespace of the node and its topics",
            ),
            DeclareLaunchArgument(
                "log_level",
                default_value="info",
                description="debug, info, warn, error or fatal",
            ),
            DeclareLaunchArgument(
                "params_file",
                default_value=str(PARAMETERS),
                description="YAML file with the parameters of the node",
            ),
            DeclareLaunchArgument(
                "listen_address",
                default_value="",
                description="address of the interface to listen on (if empty: the value in params_file)",
            ),
            DeclareLaunchArgument(
                "listen_port",
                default_value="",
                description="UDP port for the datagrams of all peers; 0 chooses a free port (if empty: the value in params_file)",
            ),
            DeclareLaunchArgument(
                "dst_ip",
                default_value="",
                description="address or name of the host on which the peers listen (if empty: the value in params_file)",
            ),
            DeclareLaunchArgument(
                "dst_a_port",
                default_value="",
                description="UDP port of basestation (if empty: the value in params_file)",
            ),
            DeclareLaunchArgument(
                "dst_b_port",
                default_value="",
                description="UDP port of hardware (if empty: the value in params_file)",
            ),
            GroupAction(
                [
                    set_parameter("listen_address"),
                    set_parameter("listen_port"),
                    set_parameter("dst_ip"),
                    set_parameter("dst_a_port"),
                    set_parameter("dst_b_port"),
                    Node(
                        package="comms",
                        executable="comms_node",
                        namespace=LaunchConfiguration("namespace"),
                        arguments=["--middleware", LaunchConfiguration("middleware")],
                        ros_arguments=[
                            "--log-level",
                            LaunchConfiguration("log_level"),
                            "--params-file",
                            LaunchConfiguration("params_file"),
                        ],
                        output="screen",
                    ),
                ]
            ),
        ]
    )


def set_parameter(name: str) -> SetParameter:
    """Override a parameter of params_file if the argument of the same name is not empty."""
    value = LaunchConfiguration(name)
    return SetParameter(
        name, value, condition=IfCondition(PythonExpression(["'", value, "' != ''"]))
    )
