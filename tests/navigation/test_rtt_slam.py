"""The ROS 2 package rtt_slam, without ROS 2: its files name each other, and its programs are commands of roverlink."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml
from golden import ROOT

from roverlink.command_line import command_line

_PACKAGE = ROOT / "navigation"
_LAUNCH_FILES = sorted((_PACKAGE / "launch").glob("*_launch.yaml"))


def _entities(actions: list[dict[str, Any]]) -> Iterator[tuple[str, dict[str, Any]]]:
    """Each action of a launch file with its kind, also those in groups."""
    for action in actions:
        ((kind, content),) = action.items()
        if kind == "group":
            yield from _entities(content["children"] if isinstance(content, dict) else content)
        else:
            yield kind, content


def _all_of(path: Path, wanted: str) -> list[dict[str, Any]]:
    whole = yaml.safe_load(path.read_text(encoding="utf-8"))
    return [content for kind, content in _entities(whole["launch"]) if kind == wanted]


@pytest.mark.parametrize("path", _LAUNCH_FILES, ids=lambda path: path.stem)
def test_every_argument_has_a_default_and_a_description(path: Path) -> None:
    """So that a launch file starts without arguments, and --show-args explains them; no value is missing in a file."""
    arguments = _all_of(path, "arg")
    assert arguments
    for one in arguments:
        assert isinstance(one["default"], str), one
        assert one["description"], one
    for file in re.findall(r"\$\((?:dirname|find-pkg-share rtt_slam)\)/([\w./-]+\.(?:yaml|rviz))", path.read_text()):
        folder = _PACKAGE / "launch" if file.startswith("..") else _PACKAGE
        assert (folder / file).is_file(), file


def test_every_program_of_the_launch_files_is_installed_and_is_a_command() -> None:
    """CMake makes the programs from a list of commands of roverlink."""
    text = (_PACKAGE / "CMakeLists.txt").read_text(encoding="utf-8")
    (listed,) = re.findall(r"foreach\(COMMAND (.*)\)", text)
    commands = re.findall(r'"([\w ]+)"', listed)
    nodes = [node for path in _LAUNCH_FILES for node in _all_of(path, "node")]
    used = {node["exec"] for node in nodes if node["pkg"] == "rtt_slam"}
    assert used <= {command.replace(" ", "_") for command in commands}
    for command in commands:
        with pytest.raises(SystemExit) as end:
            command_line(command.split()).parse_args([*command.split(), "--help"])
        assert end.value.code == 0, command


def test_the_maps_in_rviz_get_what_was_published_before() -> None:
    """RTAB-Map and the costmaps publish their maps once, for subscribers that may come later."""
    whole = yaml.safe_load((_PACKAGE / "rviz" / "rover.rviz").read_text(encoding="utf-8"))
    displays = whole["Visualization Manager"]["Displays"]
    maps = {one["Topic"]["Value"]: one["Topic"] for one in displays if one["Class"] == "rviz_default_plugins/Map"}
    assert sorted(maps) == ["global_costmap/costmap", "local_costmap/costmap", "map"]
    assert {topic["Durability Policy"] for topic in maps.values()} == {"Transient Local"}
    assert not [
        one["Name"] for one in displays if one.get("Topic", {}).get("Value", "").startswith("/")
    ], "in a namespace"


def test_one_node_publishes_each_transform() -> None:
    """RTAB-Map publishes map -> odom only where the filter of the map is not started, and its odometry nothing."""
    config = {path.stem: yaml.safe_load(path.read_text(encoding="utf-8")) for path in _PACKAGE.glob("config/*.yaml")}
    published = {
        mode: config[f"rtabmap_{mode}"]["/**/rtabmap"]["ros__parameters"]["publish_tf"]
        for mode in ("slam", "landmarks")
    }
    assert published == {"slam": True, "landmarks": False}
    assert config["rtabmap"]["/**/rgbd_odometry"]["ros__parameters"]["publish_tf"] is False
    (launch,) = (path for path in _LAUNCH_FILES if path.stem == "localization_launch")
    whole = yaml.safe_load(launch.read_text(encoding="utf-8"))["launch"]
    (outer,) = (action["group"] for action in whole if "group" in action)
    (inner,) = (action["group"] for action in outer if "group" in action)
    assert inner["if"] == "$(var map_filter)"
    assert "ekf_filter_node_map" in [node["node"]["name"] for node in inner["children"]]
