"""`roverlink check-launch`: what it finds in launch files and parameter files, and where."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping
from pathlib import Path

import pytest

from check_launch import own_programs
from roverlink.__main__ import main
from roverlink.nodes import Direction, NodeDeclaration, Parameter, Topic

_RTABMAP = "launch:\n  - node: {pkg: rtabmap_slam, exec: rtabmap, name: rtabmap, param: [{from: p.yaml}]}\n"
_CONTROLLER = (
    "launch:\n  - node:\n      pkg: nav2_controller\n      exec: controller_server\n      name: controller_server\n"
    "      param: [{from: p.yaml}]\n"
)


Write = Callable[[Mapping[str, str]], None]
Check = Callable[..., tuple[int, list[str]]]


def _parameters(node: str, *lines: str) -> str:
    return f"{node}:\n  ros__parameters:\n" + "".join(f"    {line}\n" for line in lines)


Case = tuple[dict[str, str], list[str]]
"""Files, of which the first one is checked, and the beginnings of the findings."""


def _rtabmap(*lines: str, finding: str, launch: str = _RTABMAP) -> Case:
    """RTAB-Map with some lines in its parameter file."""
    return {"a_launch.yaml": launch, "p.yaml": _parameters("rtabmap", *lines)}, [finding]


def _controller(*lines: str, finding: str, node: str = "controller_server") -> Case:
    """Nav2's controller with some lines in its parameter file."""
    return {"a_launch.yaml": _CONTROLLER, "p.yaml": _parameters(node, *lines)}, [finding]


_EKF = "launch:\n  - node: {pkg: robot_localization, exec: ekf_node, name: ekf, param: [{from: p.yaml}]}\n"
_COSTMAP = """\
local_costmap:
  local_costmap:
    ros__parameters:
      plugins: [voxel_layer]
      voxel_layer:
        plugin: nav2_costmap_2d::VoxelLayer
        z_voxels: 20
        observation_sources: points
        point: {topic: /points}
"""
_CASES: Mapping[str, Case] = {
    "a renamed parameter": _rtabmap('Grid/FromDepth: "true"', finding="p.yaml:3:5: PAR101 it is now 'Grid/Sensor'"),
    "a parameter that never existed": _rtabmap('Grid/UseVoxelFilter: "true"', finding="p.yaml:3:5: PAR101"),
    "an argument for no parameter": (
        {"a_launch.yaml": "launch:\n  - node: {pkg: rtabmap_slam, exec: rtabmap, args: --Grid/CelSize 0.05}\n"},
        ["a_launch.yaml:2:5: PAR101 did you mean '--Grid/CellSize'?"],
    ),
    "a bridge of the rover with a parameter of one that is another end": (
        {
            "a_launch.yaml": "launch:\n  - node: {pkg: msgs, exec: msgs_node, param: [{name: rover_port, value: 1}]}\n"
            "  - node: {pkg: msgs, exec: msgs_node, args: --as base, param: [{name: rover_port, value: 1}]}\n",
            "mapping.yaml": "version: 1\nproto: {root: proto}\nenvelope: {file: e.proto, message: E, oneof: payload}\n"
            "ros: {package: msgs}\npeers: {base: {port: 6000}}\nmessages: []\n",
        },
        ["a_launch.yaml:2:55: PAR101"],
    ),
    "a number in place of a text": _rtabmap("Grid/CellSize: 0.05", finding='p.yaml:3:5: PAR103 write "0.05"'),
    "a whole number in place of a floating point number": _controller(
        "controller_frequency: 20", finding="p.yaml:3:5: PAR103 write 20.0"
    ),
    "whole numbers in a list of floating point numbers": (
        {
            "a_launch.yaml": "launch:\n  - node: {pkg: nav2_velocity_smoother, exec: velocity_smoother, "
            "name: velocity_smoother, param: [{from: p.yaml}]}\n",
            "p.yaml": _parameters("velocity_smoother", "max_velocity: [1, 0, 2]"),
        },
        ["p.yaml:3:5: PAR103 write [1.0, 0.0, 2.0]"],
    ),
    "a parameter one level too high": _controller(
        "acc_lim_theta: 0.5", finding="p.yaml:3:5: PAR102 it belongs to 'FollowPath.acc_lim_theta'"
    ),
    "a section for no node": _controller(
        "controller_frequency: 20.0",
        node="controler_server",
        finding="p.yaml:1:1: PAR105 did you mean 'controller_server'?",
    ),
    "a section without the node's namespace": _rtabmap(
        "frame_id: base_link",
        launch=_RTABMAP.replace("name: rtabmap,", "name: rtabmap, namespace: rover,"),
        finding="p.yaml:1:1: PAR105 write '/rover/rtabmap', or '/**/rtabmap' for any namespace",
    ),
    "a section in another one": _controller(
        "local_costmap:",
        "  local_costmap: {ros__parameters: {width: 5, height: 5}}",
        finding="p.yaml:4:41: PAR102 move 'local_costmap.local_costmap' out of 'controller_server'",
    ),
    "a parameter twice": _rtabmap("frame_id: a", "frame_id: b", finding="p.yaml:3:5: PAR106"),
    "a parameter of the y axis alone": _controller(
        "FollowPath: {plugin: dwb_core::DWBLocalPlanner, max_vel_y: 0.3}",
        finding="p.yaml:3:53: PAR107 did you mean 'FollowPath.max_vel_x'?",
    ),
    "a file that another value of an argument chooses": (
        {
            "a_launch.yaml": _RTABMAP.replace("p.yaml", "$(dirname)/$(var mode).yaml").replace(
                "launch:\n", "launch:\n  - arg: {name: mode, default: p, choice: [{value: p}, {value: q}]}\n"
            ),
            "p.yaml": _parameters("rtabmap", "frame_id: a"),
            "q.yaml": _parameters("rtabmap", "frame_di: a"),
        },
        ["q.yaml:3:5: PAR101 did you mean 'frame_id'?"],
    ),
    "an unknown plugin": _controller(
        "FollowPath: {plugin: dwb_core::DWBLocalPlaner}",
        finding="p.yaml:3:18: PLG101 did you mean 'dwb_core::DWBLocalPlanner'?",
    ),
    "a plugin of another kind": _controller(
        "FollowPath:", "  plugin: nav2_costmap_2d::VoxelLayer", finding="p.yaml:4:7: PLG101"
    ),
    "a source of observations that is not listed": (
        {"a_launch.yaml": _CONTROLLER, "p.yaml": _COSTMAP},
        ["p.yaml:7:9: PAR104", "p.yaml:9:17: PAR102 did you mean 'points'?"],
    ),
    "a numbered sensor after a gap": (
        {
            "a_launch.yaml": _EKF,
            "p.yaml": _parameters("ekf", "odom0: a", "odom0_queue_size: 2", "odom2: b", "odom1_differential: true"),
        },
        ["p.yaml:5:5: PAR101", "p.yaml:6:5: PAR101"],
    ),
    "a package, an executable and an attribute": (
        {
            "a_launch.yaml": "launch:\n  - node: {pkg: rtabmap_slamm, exec: rtabmap}\n"
            "  - node: {pkg: rtabmap_slam, exec: rtabmapp}\n  - node: {pkg: rviz2, exec: rviz2, nmae: r}\n"
        },
        [
            "a_launch.yaml:2:5: LCH107 did you mean 'rtabmap_slam'?",
            "a_launch.yaml:3:5: LCH108 did you mean 'rtabmap'?",
            "a_launch.yaml:4:37: LCH103 did you mean 'name'?",
        ],
    ),
    "a launch file of ROS 1": (
        {
            "a.launch": '<launch>\n  <arg name="rate"/>\n  <node pkg="rviz" type="rviz" name="r">\n'
            '    <rosparam file="$(find rviz)/a.yaml"/>\n  </node>\n</launch>\n'
        },
        ["a.launch:3:20: LCH103 in ROS 2 it is <node exec=...>"],
    ),
    "parameters of ROS 1": (
        {"a.launch": '<launch>\n  <arg name="r" doc="Hz"/>\n  <param name="rate" value="$(var r)"/>\n</launch>\n'},
        ["a.launch:2:17: LCH103 in ROS 2 it is"],
    ),
    "an argument that is not declared": (
        {"a.launch.xml": '<launch>\n  <node pkg="rviz2" exec="rviz2" name="$(var nam)"/>\n</launch>\n'},
        ["a.launch.xml:2:3: LCH104 declare it with `arg`"],
    ),
    "a remapping without effect": (
        {
            "a_launch.yaml": "launch:\n  - node:\n      pkg: rtabmap_slam\n      exec: rtabmap\n      remap:\n"
            "        - {from: rgb/image_raw, to: a}\n        - {from: /rgb/image_raw, to: a}\n        - {from: a}\n"
        },
        [
            "a_launch.yaml:5:7: LCH103",
            "a_launch.yaml:6:18: TOP101 did you mean 'rgb/image'?",
            "a_launch.yaml:7:18: TOP101 did you mean '/rgb/image'?",
        ],
    ),
    "a topic that is spelled in two ways": (
        {
            "a.launch.xml": '<launch>\n  <node pkg="imu_filter_madgwick" exec="imu_filter_madgwick_node" name="f">\n'
            '    <param name="use_mag" value="false"/>\n    <remap from="imu/data" to="camera/imu/data"/>\n  </node>\n'
            '  <node pkg="rtabmap_odom" exec="rgbd_odometry">\n    <param name="wait_imu_to_init" value="true"/>\n'
            '    <remap from="imu" to="camera/imu/dta"/>\n  </node>\n</launch>\n'
        },
        ["a.launch.xml:8:23: TOP102 did you mean '/camera/imu/data'?"],
    ),
    "a QoS that does not fit": (
        {
            "a_launch.yaml": "launch:\n  - node:\n      pkg: realsense2_camera\n      exec: realsense2_camera_node\n"
            "      name: camera\n      namespace: camera\n      param:\n        - {name: enable_gyro, value: true}\n"
            "        - {name: enable_accel, value: true}\n        - {name: unite_imu_method, value: 2}\n"
            "  - node:\n      pkg: rtabmap_odom\n      exec: rgbd_odometry\n      param: [{name: qos_imu, value: 1}]\n"
            "      remap: &imu [{from: imu, to: camera/camera/imu}]\n"
            "  - node: {pkg: rtabmap_slam, exec: rtabmap, param: [{name: qos, value: 1}], remap: *imu}\n"
        },
        ["a_launch.yaml:15:36: TOP105"],
    ),
    "a transform that two nodes publish": (
        {
            "a_launch.yaml": "launch:\n  - node: {pkg: rtabmap_odom, exec: rgbd_odometry}\n"
            "  - node: {pkg: robot_localization, exec: ekf_node}\n"
        },
        ["a_launch.yaml:3:5: FRM101 let only one of them publish it, such as with the parameter publish_tf"],
    ),
    "a frame that is spelled wrongly": (
        {
            "a_launch.yaml": "launch:\n  - node:\n      pkg: tf2_ros\n      exec: static_transform_publisher\n"
            "      args: --frame-id base_link --child-frame-id camera_link\n"
            "  - node: {pkg: rtabmap_slam, exec: rtabmap, param: [{name: frame_id, value: base_lnik}]}\n"
        },
        ["a_launch.yaml:6:61: FRM102 did you mean 'base_link'?"],
    ),
    "a branch that is not taken by default": (
        {
            "a_launch.yaml": "launch:\n  - arg: {name: viz, default: 'false'}\n"
            "  - node: {pkg: rtabmap_slam, exec: rtabmapp, if: $(var viz)}\n"
        },
        ["a_launch.yaml:3:5: LCH108 did you mean 'rtabmap'?"],
    ),
}


@pytest.fixture
def write(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Write:
    """Writes files into the working directory."""
    monkeypatch.chdir(tmp_path)

    def write(files: Mapping[str, str]) -> None:
        for name, text in files.items():
            (tmp_path / name).parent.mkdir(exist_ok=True)
            (tmp_path / name).write_text(text, encoding="utf-8")

    return write


@pytest.fixture
def check(write: Write, capsys: pytest.CaptureFixture[str]) -> Check:
    """Checks; the exit code, and a line for each finding that is no hint: place, rule and help."""

    def check(*arguments: str) -> tuple[int, list[str]]:
        code = main(["check-launch", "--format", "json", *arguments])
        found = [one for one in json.loads(capsys.readouterr().out) if one["severity"] != "hint"]
        places = [f"{one['path']}:{one['line']}:{one['column']}: {one['id']}" for one in found]
        return code, [f"{place} {one['help'] or ''}".strip() for place, one in zip(places, found)]

    return check


@pytest.mark.parametrize("name", _CASES)
def test_a_mistake_is_found_at_its_place(name: str, write: Write, check: Check) -> None:
    """Each mistake gives its finding with file, line, column and what to write, and no other finding."""
    files, expected = _CASES[name]
    write(files)
    code, found = check(next(iter(files)))
    assert (code, len(found)) == (1, len(expected)), found
    for line, wanted in zip(found, expected, strict=True):
        assert line.startswith(wanted)


_PYTHON = """
import os
from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, GroupAction, OpaqueFunction
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration, PythonExpression
from launch_ros.actions import Node, PushRosNamespace, SetParameter

def more(context):
    name = LaunchConfiguration('name').perform(context)
    return [Node(package='rtabmap_slam', executable='rtabmap', name=name,
                 parameters=[{'frame_id': 'base_link', 'Grid/CelSize': '0.05'}],
                 remappings=[('rgb/imag', '/camera/image')])]

def generate_launch_description():
    return LaunchDescription([
        DeclareLaunchArgument('name', default_value='slam'),
        GroupAction([
            PushRosNamespace('rover'),
            SetParameter('use_sim_time', True),
            OpaqueFunction(function=more),
            Node(package='rviz2', executable='rviz3',
                 condition=IfCondition(PythonExpression(["'", LaunchConfiguration('name'), "' == 'other'"]))),
        ]),
    ])
"""


def test_a_python_launch_file_is_expanded_where_ros_is_not_installed(write: Write, check: Check) -> None:
    """Functions, conditions and both branches of a Python launch file are checked, with lines and columns."""
    write({"a.launch.py": _PYTHON})
    assert [re.sub(r":\d+: LCH", ": LCH", line) for line in check("a.launch.py")[1]] == [
        "a.launch.py:13:56: PAR101 did you mean 'Grid/CellSize'?",
        "a.launch.py:14:31: TOP101 did you mean 'rgb/image'?",
        "a.launch.py:23: LCH108 did you mean 'rviz2'?",
    ]


_YAML_NODE = """
launch:
  - arg: {name: ns, default: rover}
  - group:
      - push_ros_namespace: {namespace: $(var ns)}
      - node:
          pkg: imu_filter_madgwick
          exec: imu_filter_madgwick_node
          name: filter
          param: [{name: use_mag, value: false}]
          remap: [{from: imu/data_raw, to: /camera/imu}]
"""
_XML_NODE = """
<launch><arg name="ns" default="rover"/><group><push_ros_namespace namespace="$(var ns)"/>
<node pkg="imu_filter_madgwick" exec="imu_filter_madgwick_node" name="filter"><param name="use_mag" value="false"/>
<remap from="imu/data_raw" to="/camera/imu"/></node></group></launch>
"""
_PYTHON_NODE = """
from dataclasses import dataclass; from launch import LaunchDescription as L
from launch.actions import *
from launch.substitutions import LaunchConfiguration as C
from launch_ros.actions import *
@dataclass
class Arguments:
    ns: DeclareLaunchArgument = DeclareLaunchArgument('ns', default_value='rover')
class Robot(GroupAction):
    def __init__(self, own): super().__init__(own if isinstance(self, GroupAction) and not hasattr(self, 'x') else [])
def generate_launch_description():
    return L([Arguments.ns, Robot([PushRosNamespace(C('ns')),
        Node(package='imu_filter_madgwick', executable='imu_filter_madgwick_node', name='filter',
             parameters=[{'use_mag': False}], remappings=[('imu/data_raw', '/camera/imu')])])])
"""


def test_the_three_kinds_of_launch_files_say_the_same(write: Write, tmp_path: Path) -> None:
    """One node in YAML, XML and Python has the same parameters, namespace and remappings: the drawings are equal."""
    drawings = set()
    for kind, text in {"yaml": _YAML_NODE.strip(), "xml": _XML_NODE.strip(), "py": _PYTHON_NODE}.items():
        write({f"rover.{kind}": text})
        assert main(["check-launch", f"rover.{kind}", "--graph", "graph.dot"]) == 0
        drawings.add((tmp_path / "graph.dot").read_text(encoding="utf-8").replace(f"rover.{kind}", "a_launch"))
    (drawing,) = drawings
    assert {"rover/filter", "camera/imu"} <= set(re.findall(r'label="([^"]+)"', drawing))


def test_dirname_stays_that_of_an_included_file_as_in_ros2(write: Write, check: Check) -> None:
    """In the arguments of an include, and after it, $(dirname) is the folder of the included file."""
    node = "  - node: {{pkg: rtabmap_slam, exec: rtabmap, name: {}, param: [{{from: {}}}]}}\n"
    include = "  - include: {file: inner/b_launch.yaml, arg: [{name: config, value: $(dirname)/q.yaml}]}\n"
    own = "$(dirname)/p.yaml"
    write(
        {
            "a_launch.yaml": f"launch:\n{node.format('before', own)}{include}{node.format('after', own)}",
            "p.yaml": _parameters("before", "frame_id: a", "of_before: 1") + _parameters("after", "of_after: 1"),
            "inner/b_launch.yaml": "launch:\n  - arg: {name: config}\n" + node.format("inner", "$(var config)"),
            "inner/p.yaml": _parameters("after", "of_after_the_include: 1"),
            "inner/q.yaml": _parameters("inner", "of_the_argument: 1"),
        }
    )
    places = ("inner/p.yaml:3:5", "inner/q.yaml:3:5", "p.yaml:4:5")
    assert check("a_launch.yaml")[1] == [f"{place}: PAR101" for place in places]


def test_programs_of_this_project_are_those_that_declare_a_node(
    write: Write, check: Check, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A module that only helps is no program. Parameters and topics are those of the declaration, whatever it says."""
    heard = Topic("heard", ("std_msgs/msg/String",), Direction.RECEIVED, "texts")
    told = Topic("told/<voice>", ("std_msgs/msg/String",), Direction.PUBLISHED, "texts")
    node = NodeDeclaration("listener", (heard, told), (Parameter("<voice>.pitch", float, "pitch in Hz"),))
    monkeypatch.setattr(own_programs, "declared_nodes", lambda: {"listen_closely": node})
    program = "  - node: {pkg: rtt_slam, exec: %s, param: [{name: %s, value: 1.0}], remap: [{from: %s, to: b}]}\n"
    known = (program % ("listen_closely", "low.pitch", topic) for topic in ("heard", "told/low"))
    write({"a_launch.yaml": "launch:\n" + "".join(known)})
    assert check("a_launch.yaml") == (0, [])
    write({"a_launch.yaml": "launch:\n" + program % ("listen_closely", "low.pitsch", "herd")})
    assert check("a_launch.yaml")[1] == [
        "a_launch.yaml:2:64: PAR101",
        "a_launch.yaml:2:105: TOP101 did you mean 'heard'?",
    ]
    write({"a_launch.yaml": "launch:\n" + program % ("objects_model_options", "a", "b")})
    assert check("a_launch.yaml") == (1, ["a_launch.yaml:2:5: LCH108 executables of rtt_slam: listen_closely"])


def _node(package: str, executable: str, **options: str) -> str:
    """Return a node of a YAML launch file with the parameter file p.yaml and more attributes."""
    more = "".join(
        f", {name}: {value}" for name, value in ({"param": "[{from: $(dirname)/p.yaml}]"} | options).items() if value
    )
    return f"  - node: {{pkg: {package}, exec: {executable}{more}}}\n"


_ACTIONS = """
from launch import LaunchDescription
from launch.actions import *
from launch.substitutions import LaunchConfiguration as C
from launch_ros.actions import LoadComposableNodes, Node
from launch_ros.descriptions import ComposableNode
def generate_launch_description():
    return LaunchDescription([%s])
"""
_INCLUDE = """
from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription
from launch.substitutions import PathJoinSubstitution
from launch_ros.substitutions import FindPackageShare
def generate_launch_description():
    return LaunchDescription([IncludeLaunchDescription(PathJoinSubstitution([FindPackageShare('%s'), 'launch', '%s']),
                                                       launch_arguments={%s}.items())])
"""
_COSTMAP_OF = "local_costmap:\n  local_costmap:\n    ros__parameters: "
_COSTMAP_SOURCE = (
    _COSTMAP_OF + "{plugins: [o], o: {plugin: 'nav2_costmap_2d::ObstacleLayer', observation_sources: s, "
    "s: {topic: /s, obstacle_range: 1.0}}}\n"
)
_LEVELS: Mapping[str, tuple[str, str, list[str]]] = {
    # A launch file or none, a parameter file, and level, rule and help of all findings.
    "a node with another name": (
        _node("robot_localization", "ekf_node", name="ekf_wheel"),
        _parameters("ekf_filter_node", "frequency: 30.0"),
        ["warning PAR105 did you mean 'ekf_wheel'?"],
    ),
    "a node of an own package with another name": (
        _node("my_rover", "driver", name="driver"),
        _parameters("drivr_node", "speed: 1.0"),
        ["hint LCH106", "warning PAR105 did you mean 'driver'?"],
    ),
    "two filters of one tree whose frames only the robot knows, and a number that strtod reads": (
        _node("robot_localization", "ekf_node", name="a", param="[{from: /etc/a.yaml}]")
        + _node("robot_localization", "ekf_node", name="b", param="[{from: /etc/b.yaml}]")
        + _node("tf2_ros", "static_transform_publisher", param="", args='"0, 0 0 0 0 0 a b"'),
        "",
        2 * ["hint LCH102"],
    ),
    **{
        f"a parameter file that the parser refuses: {text!r}": (
            _node("robot_localization", "ekf_node", name="ekf"),
            text,
            ["fatal LCH101"],
        )
        for text in (
            "ekf:\n  frequency: 30.0\n",
            "ekf:\n  ros__parameters:\n  frequency: 30.0\n",
            "ekf:\n  ros__parameters:\n    frequency:\n",
            "ros__parameters:\n  ekf: {frequency: 30.0}\n",
        )
    },
    "too few values, which the node ignores, or takes for what they are": (
        "",
        _parameters("ekf_filter_node", "odom0: /odom", "initial_state: [0.0]", "odom0_config: [true, false]"),
        ["warning PAR108", "warning PAR108"],
    ),
    "inputs that a multiplexer refuses": (
        _node("twist_mux", "twist_mux"),
        _parameters("twist_mux", "topics: {a: {topic: a, timeout: 1, priority: 300}, b: {topic: b, priority: 1}}"),
        ["error PAR103 write 1.0", "warning PAR104", "error PAR110 set 'topics.b.timeout'"],
    ),
    "a parameter of a controller in the section of its manager": (
        _node("controller_manager", "ros2_control_node"),
        _parameters("controller_manager", "drive: {type: diff_drive_controller/DiffDriveController, update_rate: 5}"),
        ["warning PAR102 it belongs to the section 'drive'"],
    ),
    **{
        f"texts of a file that are replaced if a condition is {held}": (
            "from launch.conditions import IfCondition\nfrom nav2_common.launch import ReplaceString\n"
            + _ACTIONS
            % "Node(package='robot_localization', executable='ekf_node', name='ekf', parameters="
            f"[ReplaceString('p.yaml', {{'<rate>': 'frequency'}}, IfCondition('{held}'))])",
            _parameters("ekf", "<rate>: 30.0"),
            expected,
        )
        for held, expected in (("true", []), ("false", ["warning PAR101"]))
    },
    "Foxy": (_node("controller_manager", "spawner.py", param=""), "", ["warning LCH108 did you mean 'spawner'?"]),
    "a fixed transform beside a node without scans": (
        _node("nav2_amcl", "amcl", param="")
        + _node("tf2_ros", "static_transform_publisher", param="", args="--frame-id map --child-frame-id odom"),
        "",
        ["hint FRM101"],
    ),
    "a plugin without a type": ("", _COSTMAP_OF + "{plugins: [static]}\n", ["error PLG101 set 'static.plugin'"]),
    "a polygon without a type, and a circle without a radius": (
        "",
        _parameters(
            "collision_monitor", "polygons: [A, B]", "A: {action_type: stop}", "B: {action_type: stop, type: circle}"
        ),
        ["error PAR110 set 'A.type'", "error PAR110 set 'B.radius'"],
    ),
    "a footprint that is no polygon": ("", _COSTMAP_OF + "{footprint: '[1, 2, 3, 4]'}\n", ["warning PAR109 write a"]),
    "a footprint that is a polygon": ("", _COSTMAP_OF + "{footprint: '[[.3, 0], [-0.3, .2], [0, -1]]'}\n", []),
    "a renamed parameter with two similar ones": (
        "",
        _COSTMAP_SOURCE,
        ["warning PAR101 it is now 'o.s.obstacle_max_range'"],
    ),
    "two names that are equally near": (
        "",
        _COSTMAP_SOURCE.replace("obstacle_range", "obstacle_m_range"),
        ["warning PAR101 did you mean 'o.s.obstacle_max_range' or 'o.s.obstacle_min_range'?"],
    ),
    "a short name of a plugin": (
        "",
        _parameters("controller_server", "FollowPath: {plugin: 'dwb_core::DWBLocalPlanner', critics: [BaseObstacles]}"),
        ["error PLG101 did you mean 'BaseObstacle'?"],
    ),
    "a range that the node corrects": ("", _parameters("imu_filter_madgwick", "world_frame: ENU"), ["warning PAR104"]),
    "transforms with seven words, with a period, and with a letter": (
        "".join(
            f"  - node: {{pkg: tf2_ros, exec: static_transform_publisher, args: {words}}}\n"
            for words in ("0 0 0 0 0 a b", "0 0 0 0 0 0 a b 100", "--yaw c --frame-id a --child-frame-id b")
        ),
        "",
        ["error LCH109"] * 3,
    ),
    "a node that has no lifecycle": (
        _node("robot_localization", "ekf_node", name="ekf", param="")
        + _node("nav2_lifecycle_manager", "lifecycle_manager", param="[{name: node_names, value: [ekf]}]"),
        "",
        ["error LCH110 remove it from node_names"],
    ),
    "renamed arguments of a launch file": (
        _INCLUDE % ("realsense2_camera", "rs_launch.py", "'align_depth': 'true'"),
        "",
        ["hint LCH102", "warning LCH104 it is now 'align_depth.enable'"],
    ),
    "an argument that is no text": (
        _INCLUDE % ("rtabmap_launch", "rtabmap.launch.py", "'rviz': True"),
        "",
        ["hint LCH102", "error LCH105 write 'True' with quotation marks"],
    ),
    "a misspelt package in a path": (_INCLUDE % ("rtabmap_lauch", "a.launch.py", ""), "", ["warning LCH107"]),
    "keyword arguments that no node has, and that nodes had": (
        _PYTHON_NODE.replace("name='filter'", "naem='filter', node_name='filter'"),
        "",
        [f"{level} LCH103 did you mean 'name'?" for level in ("error", "warning")],  # Foxy has node_name
    ),
    "a keyword argument that no declaration has": (
        _ACTIONS
        % "DeclareLaunchArgument('a', default='1'),\n Node(package='rviz2', executable='rvi2', arguments='-h a')",
        "",
        ["error LCH103 did you mean 'default_value'?", "warning LCH103 write ['-h', 'a']", "error LCH108 did you mean"],
    ),
    **{
        f"what launch refuses: {text}": (_ACTIONS % text, "", ["fatal LCH101"])
        for text in (
            "IncludeLaunchDescription('a.launch.py', launch_arguments={'a': '1'})",
            "Node(package='a', executable='b', parameters={})",
            "Node(package='a', executable='b', arguments=[0])",
            "[Node(package='a', executable='b')]",
            "Node(package='a', executable='b', package='c')",
            "type('Ignored', (), {})() + 1",
            "__import__('launch.conditions').conditions.IfCondition('a' == 'b')",
        )
    },
    "a list in place of a description": ("def generate_launch_description():\n    return []\n", "", ["fatal LCH101"]),
    "a name that ROS 2 refuses": (
        _node("rviz2", "rviz2", name="my-rviz", param="") + _node("rviz2", "rviz2", name="$ROBOT", param=""),
        "",
        ["error LCH112 write 'my_rviz'", "hint LCH112"],
    ),
    "elements of ROS 1": (
        "  - remap: {from: a, to: b}\n  - node: {pkg: rviz2, type: rviz2, params: [{name: a}]}\n",
        "",
        ["error LCH103 did you mean 'set_remap'?", "error LCH103", "error LCH103", "error LCH103"],
    ),
    "an alias": (
        _node("robot_localization", "ekf_node", name="ekf"),
        _parameters("ekf", "frequency: &f 30.0", "sensor_timeout: *f"),
        ["fatal LCH101"],
    ),
    "a tab before a comment": ("", _parameters("ekf", "frequency: 30.0\t# not *an alias"), []),
    "numbers of two types in a list": (
        _node("my_rover", "driver", name="driver"),
        _parameters("driver", "gains: [1, 0.5]"),
        ["hint LCH106", "error PAR103 write [1.0, 0.5]"],
    ),
    "numbers as launch_ros writes them": (
        _ACTIONS % "Node(package='nav2_velocity_smoother', executable='velocity_smoother', "
        "parameters=[{'max_velocity': [1, 0.0, 2], 'smoothing_frequency': '2e1'}])",
        "",
        [],
    ),
    "lists in lists and mappings in lists": (
        _node("robot_localization", "ekf_node", name="ekf"),
        _parameters("ekf", "frequency: [[30.0]]", "a: [{sensor_timeout: 1.0}]", "control_config: [[true], [true]]"),
        ["error PAR103", "warning PAR101 did you mean 'sensor_timeout'?", "error PAR103", "warning PAR108"],
    ),
    "a file without sections for a node in a container": (
        _ACTIONS % "LoadComposableNodes(target_container='c', composable_node_descriptions=[ComposableNode("
        "package='nav2_amcl', plugin='nav2_amcl::AmclNode', name='amcl', parameters=['p.yaml'])])",
        "alpha1: &a [0.2, 1]\n",
        ["error PAR103"],
    ),
    "a name that the command line gives": (
        "  - node:\n      pkg: robot_localization\n      exec: ekf_node\n"
        "      args: --ros-args -r __node:=ekf -p frequncy:=1.0\n"
        "      param: [{from: $(dirname)/p.yaml}]\n",
        _parameters("ekf_filter_node", "frequency: 30.0"),
        ["warning PAR101 did you mean 'frequency'?", "warning PAR105 did you mean 'ekf'?"],
    ),
    "a value": ("", _parameters("velocity_smoother", "feedback: CLOSED"), ["error PAR104 did you mean 'CLOSED_LOOP'?"]),
    "a controller that is spelled wrongly": (
        _node("controller_manager", "ros2_control_node")
        + "  - node: {pkg: controller_manager, exec: spawner, args: dive}\n",
        _parameters("controller_manager", "drive: {type: diff_drive_controller/DiffDriveController}"),
        ["error LCH109 did you mean 'drive'?"],
    ),
    "a controller in a namespace that its spawner gives": (
        _node("controller_manager", "ros2_control_node")
        + "  - node: {pkg: controller_manager, exec: spawner, args: drive --controller-ros-args '-r __ns:=/rover'}\n",
        _parameters("controller_manager", "drive: {type: diff_drive_controller/DiffDriveController}")
        + _parameters("/rover/drive", "open_loop: true"),
        [],
    ),
    "a folder": (_node("robot_localization", "ekf_node", param="[{from: $(dirname)}]"), "", ["warning LCH111"]),
    "an argument without a value": (
        "  - include: {file: $(dirname)/p.yaml}\n",
        "launch:\n  - arg: {name: map}\n",
        ["error LCH104"],
    ),
    "nothing in place of a description": ("def generate_launch_description():\n    pass\n", "", ["fatal LCH101"]),
    # What is not known is not absent.
    "an argument that is declared before a timer ends, and frames of a package that is not here": (
        "from nowhere import part\n"
        + _ACTIONS
        % "TimerAction(period=2.0, actions=[Node(package='tf2_ros', name=C('a'), "
        "executable='static_transform_publisher', arguments=['--frame-id', 'b', '--child-frame-id', [part(), 'a']])]), "
        "Node(package='tf2_ros', executable='static_transform_publisher', name='b', "
        "arguments=['--frame-id', 'c', '--child-frame-id', [part(), 'b']]), "
        "DeclareLaunchArgument('a', default_value='b')",
        "",
        ["hint LCH102"],
    ),
    "an action of another package": ("  - pyenv_node: {pkg: my_rover}\n", "", ["hint LCH103"]),
    **{
        f"two topics of which a short word or a number differs: {name}": (
            _node("nav2_velocity_smoother", "velocity_smoother", remap=f"[{{from: cmd_vel, to: cmd_vel_nav}}, {name}]"),
            _parameters("velocity_smoother", "feedback: OPEN_LOOP"),
            [],
        )
        for name in ("{from: cmd_vel_smoothed, to: cmd_vel_raw}", "{from: cmd_vel_smoothed, to: cmd_vel_nav_2}")
    },
    "a node of another package with a usual name": (
        _node("my_cameras", "camera_node", name="camera"),
        _parameters("camera", "video_device: /dev/video0"),
        ["hint LCH106"],
    ),
    **{
        f"a launch file without a mistake: {text}": (text, "", [])
        for text in (
            "  - push_ros_namespace: {namespace: $(var ns)}\n  - arg: {name: ns, default: $(var ns)}\n",
            "  - arg: {name: a, default: 'true'}\n  - arg: {name: b, default: 'false'}\n"
            "  - node: {pkg: robot_localization, exec: ekf_node, if: $(var a)}\n"
            "  - node: {pkg: robot_localization, exec: ekf_node, if: $(var b)}\n",
            _node("rtabmap_odom", "rgbd_odometry", param="[{name: qos, value: 2}]")
            + _node("rtabmap_slam", "rtabmap", param="[{name: qos, value: 2}]"),
        )
    },
    "an own plugin": (
        "",
        _parameters("behavior_server", "behavior_plugins: [b]", "b: {plugin: my_behaviors/BackUp}", "max_radius: 2.0"),
        ["hint PLG102", "hint PAR101"],
    ),
    "own nodes of behavior trees": (
        "",
        _parameters("bt_navigator", "plugin_lib_names: [my_bt_node]", "my_radius: 1.0", "global_frame: map"),
        ["hint PAR101"],
    ),
    "a file with a part of the parameters": ("", _parameters("controller_server", "FollowPath: {vx_max: 1.0}"), []),
    "a parameter of a library, and one in a second document": (
        "",
        _parameters("rtabmap", "diagnostic_updater.period: 0.5") + "---\n" + _parameters("amcl", "alpha1: a"),
        ["error PAR103"],
    ),
    "an argument for a part that is switched off": (
        "  - include: {file: $(dirname)/p.yaml, arg: [{name: rate, value: a}]}\n",
        "launch:\n  - include: {file: $(dirname)/q.yaml, if: 'false'}\n",
        [],
    ),
    "two parents of a frame, by default and with an argument": (
        "  - arg: {name: a, default: 'false'}\n"
        + _node("robot_localization", "ekf_node", param="")
        + _node("rtabmap_odom", "rgbd_odometry", param="", **{"if": "$(var a)"}),
        "",
        ["warning FRM101"],
    ),
    "displays that are not known": (
        _node("rviz2", "rviz2", args="-d /etc/a.rviz", param="[{name: robot_description_semantic, value: a}]"),
        "",
        [],
    ),
    "a file of the robot": (_node("rviz2", "rviz2", param="[{from: /etc/a.yaml}]"), "", ["hint LCH102"]),
    "a program of the robot": (
        "import shutil, subprocess\nfrom launch import LaunchDescription\ndef generate_launch_description():\n"
        "    {'rover': 1}[subprocess.check_output([shutil.which('rover-maps')])[:5].decode()]\n"
        "    return LaunchDescription()\n",
        "",
        ["hint LCH102"],
    ),
    "a parameter above an unknown launch file": (
        "  - set_parameter: {name: a, value: 1}\n  - include: {file: $(find-pkg-share a_rover)/launch/a.launch.py}\n"
        "  - node: {pkg: rviz2, exec: rviz2}\n",
        "",
        ["hint PAR101", "hint LCH102"],
    ),
}


@pytest.mark.parametrize("name", _LEVELS)
def test_level_and_advice_of_a_finding(
    name: str, write: Write, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A node refuses errors and ignores warnings; near something unknown, "has no" is a hint."""
    launch, parameters, expected = _LEVELS[name]
    ending = "py" if "def " in launch else "yaml"
    write({f"a.launch.{ending}": launch if ending == "py" else f"launch:\n{launch}", "p.yaml": parameters})
    main(["check-launch", "--format", "json", f"a.launch.{ending}" if launch else "p.yaml"])
    found = json.loads(capsys.readouterr().out)
    lines = [f"{one['severity']} {one['id']} {one['help'] or ''}" for one in found if one["id"] not in _LOOSE_ENDS]
    assert len(lines) == len(expected), lines
    for line, wanted in zip(lines, expected, strict=True):
        assert line.startswith(wanted), lines


_LOOSE_ENDS = ("TOP104", "FRM103")


def test_velocities_with_and_without_a_stamp_do_not_fit(write: Write, check: Check) -> None:
    """Since Jazzy, a parameter decides the type of the velocity, and both ends must decide the same."""
    stamped = "[{name: enable_stamped_cmd_vel, value: true}]"
    nodes = _node("nav2_controller", "controller_server", param=stamped)
    write({"a_launch.yaml": f"launch:\n{nodes}" + _node("nav2_velocity_smoother", "velocity_smoother", param="")})
    assert [line[:25] for line in check("a_launch.yaml", "--distribution", "jazzy")[1]] == ["a_launch.yaml:3:5: TOP106"]
    write({"a_launch.yaml": f"launch:\n{nodes}" + _node("nav2_velocity_smoother", "velocity_smoother", param=stamped)})
    assert check("a_launch.yaml", "--distribution", "jazzy") == (0, [])
    write({"p.yaml": _parameters("bt_navigator", "plugin_lib_names: [nav2_spin_action_bt_node]")})
    assert check("p.yaml") == (0, [])  # Humble loads what the list names; Jazzy adds it to its own
    assert check("p.yaml", "--distribution", "jazzy")[1] == ["p.yaml:3:5: PLG103 list only libraries of your own"]


def test_the_map_of_a_costmap_is_that_of_the_namespace_around_it(write: Write, check: Check) -> None:
    """Kilted looks for a relative name there, earlier distributions in the costmap's own namespace."""
    static = "{plugins: [s], s: {plugin: 'nav2_costmap_2d::StaticLayer', map_topic: map}}"
    write(
        {
            "a_launch.yaml": "launch:\n"
            + _node("nav2_map_server", "map_server", namespace="rover", param="")
            + _node("nav2_planner", "planner_server", namespace="rover", name="planner_server"),
            "p.yaml": f"/**/global_costmap:\n  global_costmap:\n    ros__parameters: {static}\n",
        }
    )
    assert not any("TOP102" in line for line in check("a_launch.yaml", "--complete", "--distribution", "kilted")[1])
    assert any("TOP102" in line for line in check("a_launch.yaml", "--complete", "--distribution", "humble")[1])


def test_what_only_some_distributions_refuse_is_a_warning(write: Write, capsys: pytest.CaptureFixture[str]) -> None:
    """The texts of a workspace may name its distribution; of one without a catalogue, nothing is certain."""
    of_jazzy = "G: {plugin: 'nav2_navfn_planner::NavfnPlanner'}"
    planner = _parameters("planner_server", "planner_plugins: [G]", of_jazzy)
    write({"p.yaml": planner})
    assert main(["check-launch", "p.yaml"]) == 0  # the distribution that refuses the least is the likeliest
    either = planner.replace("[G]", "[G, H]") + "    H: {plugin: 'nav2_navfn_planner/NavfnPlanner'}\n"
    amcl = _parameters("amcl", "robot_model_type: differential")  # as in Foxy and Galactic
    for text, parameters, level, end in (
        ("", either, "warning", "(in humble; not in jazzy, not in kilted)"),
        ("", amcl, "warning", "(in humble; right in older distributions)"),
        ("# ROS 2 Foxy, not Humble", planner, "hint", "(in humble; there is no catalogue of foxy)"),
        ("FROM ros:humble-ros-base", planner, "error", "for 'planner_plugins'"),
        ("FROM ros:humble-ros-base", amcl, "error", "for 'robot_model_type'"),
    ):
        write({"p.yaml": parameters, "docker/Dockerfile": text})
        assert main(["check-launch", "p.yaml"]) == (level != "hint")
        assert re.search(f"{level}\\[PLG101\\].*{re.escape(end)}\n", capsys.readouterr().out)


def test_many_unknown_parameters_are_summed_up(write: Write, capsys: pytest.CaptureFixture[str]) -> None:
    """A search for the likely name takes milliseconds: only the first two hundred are reported one by one."""
    write({"p.yaml": _parameters("ekf_filter_node", "frequency: 30.0", *(f"q{i}: 0.0" for i in range(1000)))})
    main(["check-launch", "--format", "json", "p.yaml"])
    messages = [one["message"] for one in json.loads(capsys.readouterr().out)]
    assert len(messages) == 201
    assert "and none of 799 more" in messages[-1]


def test_a_misspelt_dependency_is_found_wherever_its_folder_is_used(write: Write, check: Check) -> None:
    """The manifest says which packages exist; one that it names is no misspelling of another one."""
    node = "launch:\n  - node: {pkg: rviz2, exec: rviz2, args: -d $(find-pkg-share %s)/a}\n"
    write(
        {
            "package.xml": "<package><name>r</name><depend>rover_description</depend></package>",
            "a_launch.yaml": node % "rover_desription",
            "b_launch.yaml": node % "rover_description",
            "c_launch.yaml": node % "rover_description2",
        }
    )
    assert check("a_launch.yaml")[1] == ["a_launch.yaml:2:5: LCH107 did you mean 'rover_description'?"]
    assert check("b_launch.yaml") == check("c_launch.yaml") == (0, [])


def test_what_moveit_starts_is_unknown_also_beside_its_sources(write: Write, check: Check) -> None:
    """A launch file that calls moveit_configs_utils is right, although the module that it calls is no launch file."""
    moveit = "from moveit_configs_utils.launches import generate_rsp_launch\n"
    write({"m/package.xml": "<package><name>moveit_configs_utils</name></package>", "m/launches.py": ""})
    write({"a.launch.py": f"{moveit}def generate_launch_description():\n    return generate_rsp_launch(None)\n"})
    assert check("a.launch.py") == (0, [])


def test_the_summary_says_how_much_was_looked_at(write: Write, capsys: pytest.CaptureFixture[str]) -> None:
    """Launch files that need more than is here, those of ROS 1, and files of unknown nodes are counted."""
    write(
        {
            "a.launch.py": "from a_package_of_the_robot import generate_launch_description\n",
            "b_launch.yaml": "launch:\n" + _node("my_rover", "driver", name="d"),
            "c.launch": '<launch><node pkg="rviz" type="rviz" name="rviz"/></launch>',
            "package.xml": "<package><buildtool_depend>catkin</buildtool_depend></package>",
            "p.yaml": _parameters("d", "speed: 1.0"),
            "template.yaml": _parameters("d", "gains: [__GAIN__, 1.0]"),
            "jinja.yaml": _parameters("{{ name }}/d", "speed: 1.0"),
        }
    )
    assert main(["check-launch", "."]) == 0
    extent = "1 of 2 launch files evaluated, 1 launch file of ROS 1, 3 of 3 parameter files not checked, "
    extent += "with the catalogue of humble.\n"
    assert capsys.readouterr().out.endswith(extent)


def test_a_package_may_install_files_that_stand_beside_it(write: Write, check: Check) -> None:
    """A launch file of a package is missing only if no file beside the packages has its name."""
    include = "launch:\n  - include: {file: $(find-pkg-share r)/launch/%s.launch.yaml}\n"
    write({"r/package.xml": "<package><name>r</name></package>", "launch/b.launch.yaml": "launch: []\n"})
    write({"a_launch.yaml": include % "b", "c_launch.yaml": include % "d"})
    assert check("a_launch.yaml", "--packages", ".") == (0, [])
    assert check("c_launch.yaml", "--packages", ".")[0] == 2


def test_a_launch_file_beside_a_parameter_file_says_which_node_reads_it(write: Write, check: Check) -> None:
    """The name of a node is that in the launch file; only launch files that are no programs are read for this."""
    name = _parameters("ekf_of_the_mast", "frequncy: 30.0")
    launch = "launch:\n" + _node("robot_localization", "ekf_node", name="ekf_of_the_mast")
    write({"package.xml": "<package/>", "launch/a_launch.yaml": launch.replace("p.yaml", "../p.yaml"), "p.yaml": name})
    assert check("p.yaml")[1] == ["p.yaml:3:5: PAR101 did you mean 'frequency'?"]


def test_arguments_are_set_as_for_ros2_launch(write: Write, check: Check) -> None:
    """NAME:=VALUE behind the file replaces a default, and what it chooses is checked; an unknown NAME is said."""
    nodes = "  - arg: {name: exec, default: rtabmap}\n  - node: {pkg: rtabmap_slam, exec: $(var exec)}\n"
    write({"a_launch.yaml": f"launch:\n{nodes}"})
    assert check("a_launch.yaml") == (0, [])
    assert check("a_launch.yaml", "exec:=rtab") == (1, ["a_launch.yaml:3:5: LCH108 did you mean 'rtabmap'?"])
    assert check("a_launch.yaml", "exe:=rtabmap") == (1, ["a_launch.yaml:None:None: LCH104 did you mean 'exec'?"])


def test_a_launch_file_that_starts_everything_has_no_loose_ends(write: Write, check: Check) -> None:
    """With --complete or a comment, needed topics that come from nowhere or lead to nowhere are errors."""
    node = "  - node: {pkg: nav2_velocity_smoother, exec: velocity_smoother}\n"
    write({"a_launch.yaml": f"launch:\n{node}", "b_launch.yaml": f"launch:\n  # check-launch: complete\n{node}"})
    ends = ("TOP102 topics of this type: /cmd_vel_smoothed", "TOP103 topics of this type: /cmd_vel")
    assert check("a_launch.yaml") == (0, [])
    assert check("a_launch.yaml", "--complete")[1] == [f"a_launch.yaml:2:5: {end}" for end in ends]
    assert check("b_launch.yaml")[1] == [f"b_launch.yaml:3:5: {end}" for end in ends]


def test_a_display_that_shows_nothing_is_found_in_a_complete_system(write: Write, check: Check) -> None:
    """If everything is started, displays of RViz need publishers. Updates of a map and unused tools do not count.

    A display that is switched off subscribes to nothing, so that no type is wrong for it.
    """
    display = "    - {Class: rviz_default_plugins/%s, Topic: {Value: /%s}}\n"
    poses = display % ("PoseArray, Enabled: false", "odometry/filtered")
    updates = "    - {Class: rviz_default_plugins/Map, Update Topic: {Value: /map_updates}}\n"
    shown = display % ("Image", "image") + updates + poses + "  Tools:\n" + display % ("SetGoal", "goal_pose")
    nodes = _node("rviz2", "rviz2", param="", args="-d $(dirname)/a.rviz") + _node("robot_localization", "ekf_node")
    config = f"Visualization Manager:\n  Displays:\n{shown}"
    wrong = config.replace("false", "true").replace("/Image", "/Imu")
    write({"a_launch.yaml": f"launch:\n{nodes}", "p.yaml": "{}", "a.rviz": wrong})
    found = ["a.rviz:3:15: PLG101 did you mean 'rviz_imu_plugin/Imu'?", "a.rviz:5:77: TOP106"]
    assert check("a_launch.yaml")[1] == found
    write({"a.rviz": config})
    assert check("a_launch.yaml") == (0, [])
    assert check("a_launch.yaml", "--complete")[1] == ["a.rviz:3:58: TOP102 topics of this type: /goal_pose"]


def test_a_parameter_file_is_checked_alone(write: Write, check: Check) -> None:
    """A parameter file that no launch file uses is checked by the names of its nodes, for the chosen distribution."""
    write({"nav2.yaml": _parameters("controller_server", "progress_checker_plugin: progress_checker")})
    assert check(".") == (0, [])
    (found,) = check(".", "--distribution", "jazzy")[1]
    assert found == "nav2.yaml:3:5: PAR101 it is now 'progress_checker_plugins'"
    write({"p.yaml": _parameters("ekf_filter_node", "frequncy: 30.0")})
    assert check("p.yaml")[1] == ["p.yaml:3:5: PAR101 did you mean 'frequency'?"]


_RTABMAP_NODE = "  - node: {pkg: rtabmap_slam, exec: rtabmap}\n"


@pytest.mark.parametrize(
    ("name", "text", "code", "message"),
    [
        ("a_launch.yaml", "launch:\n  - node: {pkg: a: b", 2, "a_launch.yaml:2:18: fatal[LCH101] not valid YAML: "),
        ("a_launch.yaml", "nodes: []\n", 2, "the file has no list 'launch'"),
        ("a_launch.yaml", "<launch><node></launch>", 2, "not valid XML"),
        ("a_launch.yaml", "launch:\n  - include: {file: missing_launch.yaml}\n", 2, "missing_launch.yaml"),
        ("a.launch.py", "def generate_launch_description():\n    1 / 0\n", 2, "a.launch.py:2: fatal[LCH101] the file"),
        # Near a package that is not in the catalogue, nothing is reported as missing.
        ("a_launch.yaml", "launch:\n  - node: {pkg: zed, exec: zed}\n" + _RTABMAP_NODE, 0, "'zed' is not in the"),
    ],
)
def test_what_cannot_be_read_ends_with_2(
    name: str, text: str, code: int, message: str, write: Write, capsys: pytest.CaptureFixture[str]
) -> None:
    """A broken file is a fatal finding at its place, without a traceback; an unknown package is a hint."""
    write({name: text})
    assert main(["check-launch", "--complete", name]) == code
    assert message in capsys.readouterr().out


def test_a_folder_without_launch_files_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A wrong path must not look like a success."""
    assert main(["check-launch", str(tmp_path)]) == 2
    assert "there is no launch file" in capsys.readouterr().err


@pytest.mark.parametrize("format", ["text", "json", "github", "sarif", "junit"])
def test_every_format_names_rule_and_line(format: str, write: Write, capsys: pytest.CaptureFixture[str]) -> None:
    """The output formats of the lint show the findings of this command."""
    write(_CASES["a renamed parameter"][0])
    assert main(["check-launch", "a_launch.yaml", "--format", format]) == 1
    out = capsys.readouterr().out
    assert "PAR101" in out
    assert "Grid/Sensor" in out


def test_versions_and_rules_are_explained(capsys: pytest.CaptureFixture[str]) -> None:
    """--list shows each package with its version and the commit of its source; `roverlink explain` knows the rules."""
    assert main(["check-launch", "--list", "--distribution", "jazzy"]) == 0
    lines = dict(line.split(None, 1) for line in capsys.readouterr().out.splitlines())
    assert re.fullmatch(r"1\.3\.\d+ +navigation2 [0-9a-f]{10} \d{4}-\d\d-\d\d", lines["nav2_controller"])
    assert main(["explain", "PAR101"]) == 0
    assert "silently ignores" in capsys.readouterr().out
