"""`roverlink check-launch`: what it finds in launch files and parameter files, and where."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from pathlib import Path

import pytest

from roverlink.__main__ import main

_RTABMAP = "launch:\n  - node: {pkg: rtabmap_slam, exec: rtabmap, name: rtabmap, param: [{from: p.yaml}]}\n"
_CONTROLLER = (
    "launch:\n  - node:\n      pkg: nav2_controller\n      exec: controller_server\n      name: controller_server\n"
    "      param: [{from: p.yaml}]\n"
)


def _parameters(node: str, *lines: str) -> str:
    return f"{node}:\n  ros__parameters:\n" + "".join(f"    {line}\n" for line in lines)


_CASES: Mapping[str, tuple[dict[str, str], list[str]]] = {
    "a renamed parameter": (
        {"a_launch.yaml": _RTABMAP, "p.yaml": _parameters("rtabmap", 'Grid/FromDepth: "true"')},
        ["p.yaml:3:5: PAR101 it is now 'Grid/Sensor'"],
    ),
    "a parameter that never existed": (
        {"a_launch.yaml": _RTABMAP, "p.yaml": _parameters("rtabmap", 'Grid/UseVoxelFilter: "true"')},
        ["p.yaml:3:5: PAR101"],
    ),
    "a number in place of a text": (
        {"a_launch.yaml": _RTABMAP, "p.yaml": _parameters("rtabmap", "Grid/CellSize: 0.05")},
        ['p.yaml:3:5: PAR103 write "0.05"'],
    ),
    "a whole number in place of a floating point number": (
        {"a_launch.yaml": _CONTROLLER, "p.yaml": _parameters("controller_server", "controller_frequency: 20")},
        ["p.yaml:3:5: PAR103 write 20.0"],
    ),
    "a parameter one level too high": (
        {"a_launch.yaml": _CONTROLLER, "p.yaml": _parameters("controller_server", "acc_lim_theta: 0.5")},
        ["p.yaml:3:5: PAR102 it belongs to 'FollowPath.acc_lim_theta'"],
    ),
    "a section for no node": (
        {"a_launch.yaml": _CONTROLLER, "p.yaml": _parameters("controler_server", "controller_frequency: 20.0")},
        ["p.yaml:1:1: PAR105 did you mean 'controller_server'?"],
    ),
    "a section without the node's namespace": (
        {
            "a_launch.yaml": _RTABMAP.replace("name: rtabmap,", "name: rtabmap, namespace: rover,"),
            "p.yaml": _parameters("rtabmap", "frame_id: base_link"),
        },
        ["p.yaml:1:1: PAR105 write '/rover/rtabmap', or '/**/rtabmap' for any namespace"],
    ),
    "a parameter twice": (
        {"a_launch.yaml": _RTABMAP, "p.yaml": _parameters("rtabmap", "frame_id: a", "frame_id: b")},
        ["p.yaml:3:5: PAR106"],
    ),
    "a parameter of the y axis alone": (
        {
            "a_launch.yaml": _CONTROLLER,
            "p.yaml": _parameters("controller_server", "FollowPath:", "  plugin: dwb_core::DWBLocalPlanner")
            + "      max_vel_y: 0.3\n",
        },
        ["p.yaml:5:7: PAR107 did you mean 'FollowPath.max_vel_x'?"],
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
    "an unknown plugin": (
        {
            "a_launch.yaml": _CONTROLLER,
            "p.yaml": _parameters("controller_server", "FollowPath:", "  plugin: dwb_core::DWBLocalPlaner"),
        },
        ["p.yaml:4:7: PLG101 did you mean 'dwb_core::DWBLocalPlanner'?"],
    ),
    "a plugin of another kind": (
        {
            "a_launch.yaml": _CONTROLLER,
            "p.yaml": _parameters("controller_server", "FollowPath:", "  plugin: nav2_costmap_2d::VoxelLayer"),
        },
        ["p.yaml:4:7: PLG101"],
    ),
    "a source of observations that is not listed": (
        {
            "a_launch.yaml": _CONTROLLER,
            "p.yaml": "local_costmap:\n  local_costmap:\n    ros__parameters:\n      plugins: [voxel_layer]\n"
            "      voxel_layer:\n        plugin: nav2_costmap_2d::VoxelLayer\n        z_voxels: 20\n"
            "        observation_sources: points\n        point: {topic: /points}\n",
        },
        ["p.yaml:7:9: PAR104", "p.yaml:9:17: PAR101 did you mean 'voxel_layer.points.topic'?"],
    ),
    "a numbered sensor after a gap": (
        {
            "a_launch.yaml": "launch:\n  - node: {pkg: robot_localization, exec: ekf_node, name: ekf, "
            "param: [{from: p.yaml}]}\n",
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
    "an argument that is not declared": (
        {"a.launch.xml": '<launch>\n  <node pkg="rviz2" exec="rviz2" name="$(var nam)"/>\n</launch>\n'},
        ["a.launch.xml:2:3: LCH104 declare it with `arg`"],
    ),
    "a remapping without effect": (
        {
            "a_launch.yaml": "launch:\n  - node:\n      pkg: rtabmap_slam\n      exec: rtabmap\n      remap:\n"
            "        - {from: rgb/image_raw, to: a}\n"
        },
        ["a_launch.yaml:6:18: TOP101 did you mean 'rgb/image'?"],
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
            "      remap: [{from: imu, to: camera/camera/imu}]\n"
        },
        ["a_launch.yaml:15:31: TOP105"],
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


def _check(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, list[str]]:
    """Return the exit code, and a line for each finding that is no hint: place, rule and help."""
    code = main(["check-launch", "--format", "json", *arguments])
    findings = json.loads(capsys.readouterr().out)
    lines = [
        f"{one['path']}:{one['line']}:{one['column']}: {one['id']} {one['help'] or ''}".strip()
        for one in findings
        if one["severity"] != "hint"
    ]
    return code, lines


def _write(folder: Path, files: Mapping[str, str]) -> None:
    for name, text in files.items():
        (folder / name).write_text(text, encoding="utf-8")


@pytest.mark.parametrize("name", _CASES)
def test_a_mistake_is_found_at_its_place(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Each mistake gives its finding with file, line, column and what to write, and no other finding."""
    files, expected = _CASES[name]
    _write(tmp_path, files)
    monkeypatch.chdir(tmp_path)
    code, found = _check(capsys, next(iter(files)))
    assert len(found) == len(expected), found
    for line, wanted in zip(found, expected, strict=True):
        assert line.startswith(wanted)
    assert code == 1


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


def test_a_python_launch_file_is_expanded_where_ros_is_not_installed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Functions, conditions and both branches of a Python launch file are checked, with lines and columns."""
    _write(tmp_path, {"a.launch.py": _PYTHON})
    monkeypatch.chdir(tmp_path)
    _, found = _check(capsys, "a.launch.py")
    assert [re.sub(r":\d+: LCH", ": LCH", line) for line in found] == [
        "a.launch.py:13:56: PAR101 did you mean 'Grid/CellSize'?",
        "a.launch.py:14:31: TOP101 did you mean 'rgb/image'?",
        "a.launch.py:23: LCH108 did you mean 'rviz2'?",
    ]


def test_the_three_kinds_of_launch_files_say_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """One node in YAML, XML and Python has the same parameters, namespace and remappings: the drawings are equal."""
    _write(
        tmp_path,
        {
            "a_launch.yaml": "launch:\n  - arg: {name: ns, default: rover}\n  - group:\n"
            "      - push_ros_namespace: {namespace: $(var ns)}\n      - node:\n          pkg: imu_filter_madgwick\n"
            "          exec: imu_filter_madgwick_node\n          name: filter\n"
            "          param: [{name: use_mag, value: false}]\n"
            "          remap: [{from: imu/data_raw, to: /camera/imu}]\n",
            "a_launch.xml": '<launch><arg name="ns" default="rover"/><group>'
            '<push_ros_namespace namespace="$(var ns)"/>'
            '<node pkg="imu_filter_madgwick" exec="imu_filter_madgwick_node" name="filter">'
            '<param name="use_mag" value="false"/><remap from="imu/data_raw" to="/camera/imu"/>'
            "</node></group></launch>",
            "a_launch.py": "from launch import LaunchDescription as L\nfrom launch.actions import *\n"
            "from launch.substitutions import LaunchConfiguration as C\nfrom launch_ros.actions import *\n"
            "def generate_launch_description():\n    return L([DeclareLaunchArgument('ns', default_value='rover'),\n"
            "        GroupAction([PushRosNamespace(C('ns')), Node(package='imu_filter_madgwick',\n"
            "            executable='imu_filter_madgwick_node', name='filter', parameters=[{'use_mag': False}],\n"
            "            remappings=[('imu/data_raw', '/camera/imu')])])])\n",
        },
    )
    monkeypatch.chdir(tmp_path)
    drawings = set()
    for kind in ("yaml", "xml", "py"):
        assert main(["check-launch", f"a_launch.{kind}", "--graph", "graph.svg"]) == 0
        drawings.add((tmp_path / "graph.svg").read_text(encoding="utf-8").replace(f"a_launch.{kind}", "a_launch"))
    (drawing,) = drawings
    assert {"rover/filter", "/camera/imu"} <= set(re.findall(r">([^<>]+)</text>", drawing))
    capsys.readouterr()


def test_dirname_stays_that_of_an_included_file_as_in_ros2(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """In the arguments of an include, and after it, $(dirname) is the folder of the included file."""
    (tmp_path / "inner").mkdir()
    node = "  - node: {pkg: rtabmap_slam, exec: rtabmap, name: NAME, param: [{from: FILE}]}\n"
    _write(
        tmp_path,
        {
            "a_launch.yaml": "launch:\n"
            + node.replace("NAME", "before").replace("FILE", "$(dirname)/p.yaml")
            + "  - include: {file: inner/b_launch.yaml, arg: [{name: config, value: $(dirname)/q.yaml}]}\n"
            + node.replace("NAME", "after").replace("FILE", "$(dirname)/p.yaml"),
            "p.yaml": _parameters("before", "frame_id: a", "of_before: 1") + _parameters("after", "of_after: 1"),
            "inner/b_launch.yaml": "launch:\n  - arg: {name: config}\n"
            + node.replace("NAME", "inner").replace("FILE", "$(var config)"),
            "inner/p.yaml": _parameters("after", "of_after_the_include: 1"),
            "inner/q.yaml": _parameters("inner", "of_the_argument: 1"),
        },
    )
    monkeypatch.chdir(tmp_path)
    assert _check(capsys, "a_launch.yaml")[1] == [
        "inner/p.yaml:3:5: PAR101",
        "inner/q.yaml:3:5: PAR101",
        "p.yaml:4:5: PAR101",
    ]


def test_arguments_are_set_as_for_ros2_launch(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """NAME:=VALUE behind the file replaces the default of an argument, and what it chooses is checked."""
    argument = "  - arg: {name: exec, default: rtabmap}\n"
    _write(tmp_path, {"a_launch.yaml": f"launch:\n{argument}  - node: {{pkg: rtabmap_slam, exec: $(var exec)}}\n"})
    monkeypatch.chdir(tmp_path)
    assert _check(capsys, "a_launch.yaml") == (0, [])
    assert _check(capsys, "a_launch.yaml", "exec:=rtab") == (1, ["a_launch.yaml:3:5: LCH108 did you mean 'rtabmap'?"])


def test_a_launch_file_that_starts_everything_has_no_loose_ends(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """With --complete or a comment, needed topics that come from nowhere or lead to nowhere are errors."""
    node = "  - node: {pkg: nav2_velocity_smoother, exec: velocity_smoother}\n"
    _write(
        tmp_path,
        {"a_launch.yaml": f"launch:\n{node}", "b_launch.yaml": f"launch:  # all\n  # check-launch: complete\n{node}"},
    )
    monkeypatch.chdir(tmp_path)
    assert _check(capsys, "a_launch.yaml") == (0, [])
    assert _check(capsys, "a_launch.yaml", "--complete")[1] == [
        "a_launch.yaml:2:5: TOP102 topics of this type: /cmd_vel_smoothed",
        "a_launch.yaml:2:5: TOP103 topics of this type: /cmd_vel",
    ]
    assert _check(capsys, "b_launch.yaml")[1] == [
        "b_launch.yaml:3:5: TOP102 topics of this type: /cmd_vel_smoothed",
        "b_launch.yaml:3:5: TOP103 topics of this type: /cmd_vel",
    ]


def test_a_display_that_shows_nothing_is_found_in_a_complete_system(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """If everything is started, displays of RViz need publishers. Updates of a map and unused tools do not count."""
    display = "    - {Class: rviz_default_plugins/%s, Topic: {Value: /%s}}\n"
    _write(
        tmp_path,
        {
            "a_launch.yaml": "launch:\n  - node: {pkg: rviz2, exec: rviz2, args: -d $(dirname)/a.rviz}\n",
            "a.rviz": "Visualization Manager:\n  Displays:\n"
            + display % ("Image", "image")
            + "    - {Class: rviz_default_plugins/Map, Update Topic: {Value: /map_updates}}\n  Tools:\n"
            + display % ("SetGoal", "goal_pose"),
        },
    )
    monkeypatch.chdir(tmp_path)
    assert _check(capsys, "a_launch.yaml") == (0, [])
    assert _check(capsys, "a_launch.yaml", "--complete")[1] == ["a.rviz:3:58: TOP102 topics of this type: /goal_pose"]


def test_unknown_packages_are_named_and_skipped(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A package that is not in the catalogue gives a hint; with it, nothing is reported as missing."""
    _write(
        tmp_path,
        {
            "a_launch.yaml": "launch:\n  - node: {pkg: zed_wrapper, exec: zed}\n"
            "  - node: {pkg: rtabmap_slam, exec: rtabmap}\n"
        },
    )
    monkeypatch.chdir(tmp_path)
    assert main(["check-launch", "--complete", "a_launch.yaml"]) == 0
    assert "the package 'zed_wrapper' is not in the catalogue" in capsys.readouterr().out


def test_a_parameter_file_is_checked_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A parameter file that no launch file uses is checked by the names of its nodes, for the chosen distribution."""
    _write(tmp_path, {"nav2.yaml": _parameters("controller_server", "progress_checker_plugin: progress_checker")})
    monkeypatch.chdir(tmp_path)
    assert _check(capsys, ".") == (0, [])
    assert _check(capsys, ".", "--distribution", "jazzy")[1] == [
        "nav2.yaml:3:5: PAR101 did you mean 'progress_checker_plugins'?"
    ]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("launch:\n  - node: {pkg: a", "not valid YAML"),
        ("nodes: []\n", "the file has no list 'launch'"),
        ("<launch><node></launch>", "not valid XML"),
        ("launch:\n  - include: {file: missing_launch.yaml}\n", "missing_launch.yaml"),
    ],
)
def test_a_file_that_cannot_be_read_ends_with_2(
    text: str, message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A broken file is a fatal finding at its place, and the exit code is 2."""
    _write(tmp_path, {"a_launch.yaml": text})
    monkeypatch.chdir(tmp_path)
    assert main(["check-launch", "a_launch.yaml"]) == 2
    assert message in capsys.readouterr().out


def test_a_python_file_that_stops_is_named_with_its_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """An exception in a Python launch file is a fatal finding at its line, and no traceback."""
    _write(tmp_path, {"a.launch.py": "def generate_launch_description():\n    return 1 / 0\n"})
    monkeypatch.chdir(tmp_path)
    assert main(["check-launch", "a.launch.py"]) == 2
    assert "a.launch.py:2: fatal[LCH101] the file stops here: ZeroDivisionError" in capsys.readouterr().out


def test_a_folder_without_launch_files_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A wrong path must not look like a success."""
    assert main(["check-launch", str(tmp_path)]) == 2
    assert "there is no launch file" in capsys.readouterr().err


@pytest.mark.parametrize("format", ["text", "json", "github", "sarif", "junit"])
def test_every_format_names_rule_and_line(
    format: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The output formats of the lint show the findings of this command."""
    files, _ = _CASES["a renamed parameter"]
    _write(tmp_path, files)
    monkeypatch.chdir(tmp_path)
    assert main(["check-launch", "a_launch.yaml", "--format", format]) == 1
    out = capsys.readouterr().out
    assert "PAR101" in out
    assert "Grid/Sensor" in out


def test_the_catalogue_says_for_which_versions_it_holds(capsys: pytest.CaptureFixture[str]) -> None:
    """--list shows each package with its version and the commit of its source."""
    assert main(["check-launch", "--list", "--distribution", "jazzy"]) == 0
    lines = dict(line.split(None, 1) for line in capsys.readouterr().out.splitlines())
    assert re.fullmatch(r"1\.3\.\d+ +navigation2 [0-9a-f]{10} \d{4}-\d\d-\d\d", lines["nav2_controller"])


def test_rules_are_explained(capsys: pytest.CaptureFixture[str]) -> None:
    """`roverlink explain` knows the rules of this command."""
    assert main(["explain", "PAR101"]) == 0
    assert "silently ignores" in capsys.readouterr().out
