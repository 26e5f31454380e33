"""Rules of `roverlink check-launch`: about launch files, parameters, topics and frames."""

from __future__ import annotations

import sys
from dataclasses import dataclass, fields, replace

from roverlink.generator.diagnostics import Diagnostic, Rule, Severity, rules_in


class UnreadableLaunchFile(Rule, id="LCH101", severity=Severity.FATAL):
    """A launch file or parameter file cannot be read, or its program stops with an error.

    Bad::

        launch:
          - node: {pkg: comms, exec: comms_node

    Good::

        launch:
          - node: {pkg: comms, exec: comms_node}
    """


class NotExpanded(Rule, id="LCH102", severity=Severity.HINT):
    """A part of a launch file is not checked, because it needs a package, a value or a device that is not there.

    The launch file still works on a computer that has the package. Check it there, or name folders with packages with
    `--packages`.

    Bad::

        import xacro

    Good::

        from launch_ros.actions import Node
    """


class UnknownAction(Rule, id="LCH103"):
    """A YAML or XML launch file has an action, an attribute or a substitution that ROS 2 does not know.

    `ros2 launch` refuses such a file.

    Bad::

        - node: {pkg: comms, exec: comms_node, nmae: bridge}

    Good::

        - node: {pkg: comms, exec: comms_node, name: bridge}
    """


class UndeclaredArgument(Rule, id="LCH104"):
    """A launch file uses an argument that it does not declare, or gets one that it does not have.

    `ros2 launch` stops at the use of an undeclared argument, unless the user gives it. It ignores an argument that a
    launch file does not have, so that a value from the command line or from an including file has no effect.

    Bad::

        - arg: {name: namespace, default: ""}
        - push_ros_namespace: {namespace: $(var namespce)}

    Good::

        - arg: {name: namespace, default: ""}
        - push_ros_namespace: {namespace: $(var namespace)}
    """


class WrongArgumentValue(Rule, id="LCH105"):
    """A condition is neither true nor false, or an argument has a value that it does not allow.

    Bad::

        - node: {pkg: rviz2, exec: rviz2, if: "yes"}

    Good::

        - node: {pkg: rviz2, exec: rviz2, if: "true"}
    """


class UnknownPackage(Rule, id="LCH106", severity=Severity.HINT):
    """A package is not in the catalogue, so that its nodes are not checked.

    The catalogue has the packages for SLAM and navigation, and the programs of this project. Topics and transforms of
    an unknown package are not known: with one, nothing is reported as missing.

    Bad::

        - node: {pkg: my_camera, exec: camera_node}

    Good::

        - node: {pkg: realsense2_camera, exec: realsense2_camera_node}
    """


class MisspeltPackage(Rule, id="LCH107", severity=Severity.WARNING):
    """A package is not in the catalogue, but one with nearly the same name is.

    Bad::

        - node: {pkg: rtabmap_slamm, exec: rtabmap}

    Good::

        - node: {pkg: rtabmap_slam, exec: rtabmap}
    """


class UnknownExecutable(Rule, id="LCH108"):
    """A package does not have an executable, or a node for a container.

    `ros2 launch` stops with an error.

    Bad::

        - node: {pkg: rtabmap_slam, exec: rtabmap_slam}

    Good::

        - node: {pkg: rtabmap_slam, exec: rtabmap}
    """


class RefusedArguments(Rule, id="LCH109"):
    """A program refuses the arguments of its command line, and ends.

    Bad::

        - node: {pkg: tf2_ros, exec: static_transform_publisher, args: 0 0 0 0 0 0 base_link camera_link 100}

    Good::

        - node: {pkg: tf2_ros, exec: static_transform_publisher, args: --frame-id a --child-frame-id b}
    """


class NotManaged(Rule, id="LCH110"):
    """A lifecycle manager waits for a node that it cannot start, so that no other node becomes active.

    The name in `node_names` is misspelt, or the node has no lifecycle and starts by itself.

    Bad::

        lifecycle_manager: {ros__parameters: {node_names: [controller_server, ekf_filter_node]}}

    Good::

        lifecycle_manager: {ros__parameters: {node_names: [controller_server]}}
    """


class MissingFile(Rule, id="LCH111", severity=Severity.WARNING):
    """A parameter file is not there.

    `ros2 launch` says so in a warning, and starts the node with its defaults.

    Bad::

        - node: {pkg: robot_localization, exec: ekf_node, param: [{from: $(dirname)/ekff.yaml}]}

    Good::

        - node: {pkg: robot_localization, exec: ekf_node, param: [{from: $(dirname)/ekf.yaml}]}
    """


class InvalidName(Rule, id="LCH112"):
    """A node, a namespace or a topic gets a name that ROS 2 refuses, so that the node does not start.

    A name has letters, digits and `_`, and each of its parts begins with none of the digits.

    Bad::

        - node: {pkg: rviz2, exec: rviz2, name: rviz-2}

    Good::

        - node: {pkg: rviz2, exec: rviz2, name: rviz_2}
    """


class UnknownParameter(Rule, id="PAR101", severity=Severity.WARNING):
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
    """


class MisplacedParameter(Rule, id="PAR102", severity=Severity.WARNING):
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
    """


class WrongType(Rule, id="PAR103"):
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
    """


class OutOfRange(Rule, id="PAR104"):
    """A parameter's value is outside of its range, or is none of the values that the node knows.

    Bad::

        voxel_layer: {plugin: "nav2_costmap_2d::VoxelLayer", z_voxels: 20}

    Good::

        voxel_layer: {plugin: "nav2_costmap_2d::VoxelLayer", z_voxels: 16}
    """


class SectionWithoutNode(Rule, id="PAR105", severity=Severity.WARNING):
    """A section of a parameter file is for no node that gets the file.

    The name of the section must be the name of the node with its namespace; `/**/` in front stands for any namespace.

    Bad::

        controler_server:
          ros__parameters: {controller_frequency: 20.0}

    Good::

        controller_server:
          ros__parameters: {controller_frequency: 20.0}
    """


class RepeatedParameter(Rule, id="PAR106", severity=Severity.WARNING):
    """A parameter stands twice in the same section of a file; only the last one has an effect.

    Bad::

        imu_filter:
          ros__parameters: {use_mag: false, use_mag: true}

    Good::

        imu_filter:
          ros__parameters: {use_mag: false}
    """


class OneAxis(Rule, id="PAR107", severity=Severity.WARNING):
    """A parameter is given for the y axis, and its counterpart for the x axis is not.

    Both names are right, so that no other rule finds the slip. The node takes its default for x, which is rarely meant:
    a rover drives along x.

    Bad::

        FollowPath: {plugin: "dwb_core::DWBLocalPlanner", max_vel_y: 0.3}

    Good::

        FollowPath: {plugin: "dwb_core::DWBLocalPlanner", max_vel_x: 0.3}
    """


class WrongLength(Rule, id="PAR108"):
    """A list has another number of values than the node needs.

    Bad::

        ekf_filter_node: {ros__parameters: {initial_state: [0.0, 0.0, 0.0]}}

    Good::

        velocity_smoother: {ros__parameters: {max_velocity: [0.5, 0.0, 2.0]}}
    """


class BadPolygon(Rule, id="PAR109"):
    """A footprint or polygon is no text with a list of at least three pairs of numbers.

    A costmap ignores such a footprint, with a message. A collision monitor stops with an error.

    Bad::

        local_costmap: {local_costmap: {ros__parameters: {footprint: "[0.3, 0.2, -0.3, -0.2]"}}}

    Good::

        local_costmap: {local_costmap: {ros__parameters: {footprint: "[[0.3, 0.2], [0.3, -0.2], [-0.3, 0.0]]"}}}
    """


class MissingParameter(Rule, id="PAR110"):
    """A node needs a parameter that nothing gives to it, such as the type of a polygon.

    The node stops with an error.

    Bad::

        collision_monitor: {ros__parameters: {polygons: [Stop], Stop: {radius: 0.3}}}

    Good::

        collision_monitor: {ros__parameters: {polygons: [Stop], Stop: {type: circle, action_type: stop, radius: 0.3}}}
    """


class UnknownPlugin(Rule, id="PLG101"):
    """A plugin does not exist, has no type, or has another base class than the node loads.

    The node stops with an error when it loads the plugin.

    Bad::

        voxel_layer: {plugin: "nav2_costmap_2d::VoxelLayr"}

    Good::

        voxel_layer: {plugin: "nav2_costmap_2d::VoxelLayer"}
    """


class PluginOfUnknownPackage(Rule, id="PLG102", severity=Severity.HINT):
    """A plugin is of a package that is not in the catalogue, so that its parameters are not checked.

    Bad::

        my_layer: {plugin: "my_costmap::MyLayer"}

    Good::

        voxel_layer: {plugin: "nav2_costmap_2d::VoxelLayer"}
    """


class PluginTwice(Rule, id="PLG103"):
    """A list names libraries that the node loads by itself, so that it loads them twice and stops with an error.

    Since Jazzy, `plugin_lib_names` of bt_navigator is for libraries of your own only.

    Bad::

        bt_navigator: {ros__parameters: {plugin_lib_names: [nav2_spin_action_bt_node]}}

    Good::

        bt_navigator: {ros__parameters: {plugin_lib_names: [my_dance_action_bt_node]}}
    """


class RemappingOfUnknownTopic(Rule, id="TOP101", severity=Severity.WARNING):
    """A remapping names a topic, service or action that the node does not have, so that it has no effect.

    Bad::

        - node: {pkg: rtabmap_slam, exec: rtabmap, remap: {from: rgb/image_raw, to: camera/color/image_raw}}

    Good::

        - node: {pkg: rtabmap_slam, exec: rtabmap, remap: {from: rgb/image, to: camera/color/image_raw}}
    """


class TopicWithoutPublisher(Rule, id="TOP102"):
    """A node needs a topic that nothing publishes: the flow of data is interrupted there.

    The node waits without a message, or warns again and again. It is an error if a publisher with a similar name
    exists, or with `--complete`, which says that the launch files start everything.

    Bad::

        remap: {from: rgb/image, to: camera/colour/image_raw}

    Good::

        remap: {from: rgb/image, to: camera/color/image_raw}
    """


class TopicWithoutSubscriber(Rule, id="TOP103"):
    """Nothing subscribes to a topic that has to reach another node, such as the controller's velocity.

    It is an error if a subscriber with a similar name exists, or with `--complete`, which says that the launch files
    start everything.

    Bad::

        remap: {from: cmd_vel_smoothed, to: cmd_vell}

    Good::

        remap: {from: cmd_vel_smoothed, to: cmd_vel}
    """


class TopicFromOutside(Rule, id="TOP104", severity=Severity.HINT):
    """A topic comes from outside of the launch files, or goes there.

    With `--complete`, which says that the launch files start everything, this is an error (TOP102, TOP103).

    Bad::

        observation_sources: scan

    Good::

        $ roverlink check-launch --complete launch/slam_launch.yaml
    """


class IncompatibleQos(Rule, id="TOP105"):
    """A subscriber asks for more than a publisher offers, so that no message arrives.

    A reliable subscriber gets nothing from a best-effort publisher, and a transient local subscriber nothing from a
    volatile publisher.

    Bad::

        rtabmap: {ros__parameters: {qos_imu: 1}}

    Good::

        rtabmap: {ros__parameters: {qos_imu: 2}}
    """


class DifferentTypes(Rule, id="TOP106"):
    """Two nodes use one topic with different message types, so that no message arrives.

    Bad::

        remap: {from: depth/image, to: camera/depth/color/points}

    Good::

        remap: {from: depth/image, to: camera/aligned_depth_to_color/image_raw}
    """


class FramePublishedTwice(Rule, id="FRM101"):
    """Two nodes publish the transform of one frame.

    A frame has one parent. With two publishers, the frame jumps between them.

    Bad::

        ekf_filter_node: {ros__parameters: {publish_tf: true}}
        rgbd_odometry: {ros__parameters: {publish_tf: true}}

    Good::

        ekf_filter_node: {ros__parameters: {publish_tf: true}}
        rgbd_odometry: {ros__parameters: {publish_tf: false}}
    """


class FrameWithoutTransform(Rule, id="FRM102"):
    """A node looks up a frame that nothing publishes.

    It is an error if a frame with a similar name exists, or with `--complete`, which says that the launch files start
    everything.

    Bad::

        robot_base_frame: base_lnik

    Good::

        robot_base_frame: base_link
    """


class FrameFromOutside(Rule, id="FRM103", severity=Severity.HINT):
    """A frame comes from outside of the launch files.

    Bad::

        robot_base_frame: base_link

    Good::

        $ roverlink check-launch --complete launch/slam_launch.yaml
    """


@dataclass(frozen=True, slots=True)
class OldName(Diagnostic):
    """A finding about a name that was right in older distributions."""

    @classmethod
    def of(cls, finding: Diagnostic) -> OldName:
        """Return a finding with this mark, which `as_hint` and `as_warning` keep."""
        return cls(**{part.name: getattr(finding, part.name) for part in fields(finding)})


def as_hint(finding: Diagnostic) -> Diagnostic:
    """Return a finding as a hint, because something that is not known may explain it."""
    return replace(finding, severity=Severity.HINT)


def as_warning(finding: Diagnostic) -> Diagnostic:
    """Return a finding as a warning, because the node starts in spite of it."""
    return replace(finding, severity=Severity.WARNING)


def launch_rules() -> dict[str, type[Rule]]:
    """Return all rules by their ids, such as ``PAR101``."""
    return dict(sorted(rules_in(sys.modules[__name__]).items()))
