"""Rules of `roverlink check-launch`: about launch files, parameters, topics and frames."""

from __future__ import annotations

from roverlink.generator.diagnostics import Rule, Severity

UNREADABLE = Rule(
    "LCH101",
    "unreadable-launch-file",
    """A launch file or parameter file cannot be read, or its program stops with an error.

Bad::

    launch:
      - node: {pkg: comms, exec: comms_node

Good::

    launch:
      - node: {pkg: comms, exec: comms_node}
""",
    Severity.FATAL,
)

NOT_EXPANDED = Rule(
    "LCH102",
    "not-expanded",
    """A part of a launch file is not checked, because it needs a package or a value that is not there.

The launch file still works on a computer that has the package. Check it there, or name folders with packages with
`--packages`.

Bad::

    import xacro

Good::

    from launch_ros.actions import Node
""",
    Severity.HINT,
)

UNKNOWN_ACTION = Rule(
    "LCH103",
    "unknown-action",
    """A YAML or XML launch file has an action, an attribute or a substitution that ROS 2 does not know.

`ros2 launch` refuses such a file.

Bad::

    - node: {pkg: comms, exec: comms_node, nmae: bridge}

Good::

    - node: {pkg: comms, exec: comms_node, name: bridge}
""",
)

UNDECLARED_ARGUMENT = Rule(
    "LCH104",
    "undeclared-argument",
    """A launch file uses an argument that it does not declare, or gives one to a launch file that does not have it.

`ros2 launch` stops at the use of an undeclared argument. It ignores an argument that the included launch file does not
have, so that the value has no effect.

Bad::

    - arg: {name: namespace, default: ""}
    - push_ros_namespace: {namespace: $(var namespce)}

Good::

    - arg: {name: namespace, default: ""}
    - push_ros_namespace: {namespace: $(var namespace)}
""",
)

WRONG_VALUE = Rule(
    "LCH105",
    "wrong-argument-value",
    """A condition is neither true nor false, or an argument has a value that it does not allow.

Bad::

    - node: {pkg: rviz2, exec: rviz2, if: "yes"}

Good::

    - node: {pkg: rviz2, exec: rviz2, if: "true"}
""",
)

UNKNOWN_PACKAGE = Rule(
    "LCH106",
    "unknown-package",
    """A package is not in the catalogue, so that its nodes are not checked.

The catalogue has the packages for SLAM and navigation, and the programs of this project. Topics and transforms of an
unknown package are not known: with one, nothing is reported as missing.

Bad::

    - node: {pkg: my_camera, exec: camera_node}

Good::

    - node: {pkg: realsense2_camera, exec: realsense2_camera_node}
""",
    Severity.HINT,
)

MISSPELT_PACKAGE = Rule(
    "LCH107",
    "misspelt-package",
    """A package is not in the catalogue, but one with nearly the same name is.

Bad::

    - node: {pkg: rtabmap_slamm, exec: rtabmap}

Good::

    - node: {pkg: rtabmap_slam, exec: rtabmap}
""",
)

UNKNOWN_EXECUTABLE = Rule(
    "LCH108",
    "unknown-executable",
    """A package does not have an executable, or a node for a container.

`ros2 launch` stops with an error.

Bad::

    - node: {pkg: rtabmap_slam, exec: rtabmap_slam}

Good::

    - node: {pkg: rtabmap_slam, exec: rtabmap}
""",
)

UNKNOWN_PARAMETER = Rule(
    "PAR101",
    "unknown-parameter",
    """A node does not have a parameter.

ROS 2 silently ignores a parameter that a node does not declare: the node runs with the default.

Bad::

    rtabmap:
      ros__parameters:
        Grid/FromDepth: "true"

Good::

    rtabmap:
      ros__parameters:
        Grid/Sensor: "1"
""",
)

MISPLACED_PARAMETER = Rule(
    "PAR102",
    "misplaced-parameter",
    """A parameter stands at a place where it has no effect.

It belongs to another node, to a plugin, or one level higher or lower.

Bad::

    controller_server:
      ros__parameters:
        max_vel_x: 0.3

Good::

    controller_server:
      ros__parameters:
        FollowPath:
          max_vel_x: 0.3
""",
)

WRONG_TYPE = Rule(
    "PAR103",
    "wrong-type",
    """A parameter's value has another type than the node declares.

The node stops with an error at the start. A whole number is no floating point number: write `20.0`. RTAB-Map's own
parameters, such as `Grid/CellSize`, are texts: write them with quotation marks.

Bad::

    controller_server:
      ros__parameters:
        controller_frequency: 20

Good::

    controller_server:
      ros__parameters:
        controller_frequency: 20.0
""",
)

OUT_OF_RANGE = Rule(
    "PAR104",
    "out-of-range",
    """A parameter's value is outside of its range, or is none of the values that the node knows.

Bad::

    voxel_layer: {plugin: "nav2_costmap_2d::VoxelLayer", z_voxels: 20}

Good::

    voxel_layer: {plugin: "nav2_costmap_2d::VoxelLayer", z_voxels: 16}
""",
)

UNUSED_SECTION = Rule(
    "PAR105",
    "section-without-node",
    """A section of a parameter file is for no node that gets the file.

The name of the section must be the name of the node with its namespace; `/**/` in front stands for any namespace.

Bad::

    controler_server:
      ros__parameters: {controller_frequency: 20.0}

Good::

    controller_server:
      ros__parameters: {controller_frequency: 20.0}
""",
)

REPEATED_PARAMETER = Rule(
    "PAR106",
    "repeated-parameter",
    """A parameter stands twice in the same section of a file; only the last one has an effect.

Bad::

    imu_filter:
      ros__parameters: {use_mag: false, use_mag: true}

Good::

    imu_filter:
      ros__parameters: {use_mag: false}
""",
)

ONE_AXIS = Rule(
    "PAR107",
    "one-axis",
    """A parameter is given for the y axis, and its counterpart for the x axis is not.

Both names are right, so that no other rule finds the slip. The node takes its default for x, which is rarely meant: a
rover drives along x.

Bad::

    FollowPath: {plugin: "dwb_core::DWBLocalPlanner", max_vel_y: 0.3}

Good::

    FollowPath: {plugin: "dwb_core::DWBLocalPlanner", max_vel_x: 0.3}
""",
    Severity.WARNING,
)

UNKNOWN_PLUGIN = Rule(
    "PLG101",
    "unknown-plugin",
    """A plugin does not exist, has no type, or has another base class than the node loads.

The node stops with an error when it loads the plugin.

Bad::

    voxel_layer: {plugin: "nav2_costmap_2d::VoxelLayr"}

Good::

    voxel_layer: {plugin: "nav2_costmap_2d::VoxelLayer"}
""",
)

UNCHECKED_PLUGIN = Rule(
    "PLG102",
    "plugin-of-unknown-package",
    """A plugin is of a package that is not in the catalogue, so that its parameters are not checked.

Bad::

    my_layer: {plugin: "my_costmap::MyLayer"}

Good::

    voxel_layer: {plugin: "nav2_costmap_2d::VoxelLayer"}
""",
    Severity.HINT,
)

UNKNOWN_REMAPPING = Rule(
    "TOP101",
    "remapping-of-unknown-topic",
    """A remapping names a topic, service or action that the node does not have, so that it has no effect.

Bad::

    - node: {pkg: rtabmap_slam, exec: rtabmap, remap: {from: rgb/image_raw, to: camera/color/image_raw}}

Good::

    - node: {pkg: rtabmap_slam, exec: rtabmap, remap: {from: rgb/image, to: camera/color/image_raw}}
""",
)

NO_PUBLISHER = Rule(
    "TOP102",
    "topic-without-publisher",
    """A node needs a topic that nothing publishes: the flow of data is interrupted there.

The node waits without a message, or warns again and again. It is an error if a publisher with a similar name exists, or
with `--complete`, which says that the launch files start everything.

Bad::

    remap: {from: rgb/image, to: camera/colour/image_raw}

Good::

    remap: {from: rgb/image, to: camera/color/image_raw}
""",
)

NO_SUBSCRIBER = Rule(
    "TOP103",
    "topic-without-subscriber",
    """Nothing subscribes to a topic that has to reach another node, such as the controller's velocity.

It is an error if a subscriber with a similar name exists, or with `--complete`, which says that the launch files start
everything.

Bad::

    remap: {from: cmd_vel_smoothed, to: cmd_vell}

Good::

    remap: {from: cmd_vel_smoothed, to: cmd_vel}
""",
)

OUTSIDE = Rule(
    "TOP104",
    "topic-from-outside",
    """A topic comes from outside of the launch files, or goes there.

With `--complete`, which says that the launch files start everything, this is an error (TOP102, TOP103).

Bad::

    observation_sources: scan

Good::

    $ roverlink check-launch --complete launch/slam_launch.yaml
""",
    Severity.HINT,
)

INCOMPATIBLE_QOS = Rule(
    "TOP105",
    "incompatible-qos",
    """A subscriber asks for more than a publisher offers, so that no message arrives.

A reliable subscriber gets nothing from a best-effort publisher, and a transient local subscriber nothing from a
volatile publisher.

Bad::

    rtabmap: {ros__parameters: {qos_imu: 1}}

Good::

    rtabmap: {ros__parameters: {qos_imu: 2}}
""",
)

DIFFERENT_TYPES = Rule(
    "TOP106",
    "different-types",
    """Two nodes use one topic with different message types, so that no message arrives.

Bad::

    remap: {from: depth/image, to: camera/depth/color/points}

Good::

    remap: {from: depth/image, to: camera/aligned_depth_to_color/image_raw}
""",
)

TWO_PARENTS = Rule(
    "FRM101",
    "frame-published-twice",
    """Two nodes publish the transform of one frame.

A frame has one parent. With two publishers, the frame jumps between them.

Bad::

    ekf_filter_node: {ros__parameters: {publish_tf: true}}
    rgbd_odometry: {ros__parameters: {publish_tf: true}}

Good::

    ekf_filter_node: {ros__parameters: {publish_tf: true}}
    rgbd_odometry: {ros__parameters: {publish_tf: false}}
""",
)

NO_TRANSFORM = Rule(
    "FRM102",
    "frame-without-transform",
    """A node looks up a frame that nothing publishes.

It is an error if a frame with a similar name exists, or with `--complete`, which says that the launch files start
everything.

Bad::

    robot_base_frame: base_lnik

Good::

    robot_base_frame: base_link
""",
)

FRAME_OUTSIDE = Rule(
    "FRM103",
    "frame-from-outside",
    """A frame comes from outside of the launch files.

Bad::

    robot_base_frame: base_link

Good::

    $ roverlink check-launch --complete launch/slam_launch.yaml
""",
    Severity.HINT,
)


def launch_rules() -> dict[str, Rule]:
    """Return all rules by their ids, such as ``PAR101``."""
    return dict(sorted((rule.id, rule) for rule in globals().values() if isinstance(rule, Rule)))
