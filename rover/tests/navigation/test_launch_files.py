"""The launch files of the package rtt_slam, expanded by the checker as ROS 2 expands them, and its other files.

The command lines in `cases` come from launch and launch_ros of Humble, and from the launch file of Nav2: these were run
once, with programs that wrote down how they were started. A parameter file that launch_ros made of values is in braces.
The lines for `camera_imu` and for the obstacles were added by hand, in the form of the others.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml
from check_launch.catalogue.catalogue_files import read_catalogue
from check_launch.expansion.expander import Expander, Expansion, StartedNode
from check_launch.expansion.launch_context import Packages
from golden import ROOT

from roverlink.nodes.installed import declared_nodes

_CASES = sorted((Path(__file__).parent / "cases").glob("*.txt"))
_ROS_ARGUMENTS = "--ros-args"
_Meaning = tuple[list[str], dict[str, list[str]]]
"""Words before the arguments for ROS 2, and the values of each of these in their order."""


def _expanded(file: str, *arguments: str) -> Expansion:
    """Expand a launch file of the package with arguments such as ``stvl:=true``."""
    packages = read_catalogue("humble").packages.values()
    stored = {(package.name, path): file for package in packages for path, file in package.launch_files.items()}
    expander = Expander(Packages([ROOT / "rover" / "navigation", ROOT / "generated" / "ros"]), _shown, stored, set())
    return expander.expand(
        ROOT / "rover" / "navigation" / "launch" / file, dict(one.split(":=", 1) for one in arguments)
    )


def _shown(path: str) -> str:
    return os.path.relpath(path, ROOT) if os.path.isabs(path) else path


def _words(node: StartedNode) -> Iterator[str]:
    """Spell a node as launch_ros does."""
    yield from (str(node.package), str(node.executable), *(_shown(str(word)) for word in node.arguments))
    yield _ROS_ARGUMENTS
    if node.name:
        yield from ("-r", f"__node:={node.name}")
    yield from ("-r", f"__ns:={node.namespace or '/'}")
    for one in node.remappings:
        yield from ("-r", f"{one.source}:={one.target}")
    for value in node.general_values:
        yield from ("-p", f"{value.name}:={value.value}")
    for use in node.files:
        yield from ("--params-file", use.shown)
    for value in node.values:
        yield from ("--params-file", f"{{{value.name}: {value.value}}}")


def _meaning(words: list[str]) -> _Meaning:
    """Return what a command line means to the program; the level of the log does not count."""
    start = words.index(_ROS_ARGUMENTS)
    options: dict[str, list[str]] = {}
    rest = iter(word for word in words[start:] if word != _ROS_ARGUMENTS)
    for option in rest:
        value = next(rest)
        while value.startswith("{") and not value.endswith("}"):
            value = f"{value} {next(rest)}"
        if option != "--log-level":
            options.setdefault(option, []).append(value)
    return words[:start], options


@pytest.mark.parametrize("case", _CASES, ids=lambda path: path.stem)
def test_the_programs_start_as_with_ros(case: Path) -> None:
    """Executables, arguments, names, namespaces, parameters and remappings are those that ROS 2's launch has given."""
    first, *lines = case.read_text(encoding="utf-8").splitlines()
    expansion = _expanded(*first.split())
    assert expansion.findings == []
    found = sorted((_meaning(list(_words(node))) for node in expansion.nodes), key=str)
    assert found == sorted((_meaning(line.split(" ")) for line in lines), key=str)


@pytest.mark.parametrize(("argument", "layer"), [("stvl:=false", "voxel_layer"), ("stvl:=true", "stvl_layer")])
def test_the_costmap_has_the_layer_of_the_argument(argument: str, layer: str) -> None:
    """Nav2 reads the substitutions in navigation.yaml, for the layer and for the topic in the rover's namespace."""
    expansion = _expanded("navigation_launch.yaml", argument, "namespace:=rover")
    (controller,) = (node for node in expansion.nodes if node.executable == "controller_server")
    (use,) = controller.files
    (section,) = (one for one in use.sections if one.matches("/rover/local_costmap/local_costmap"))
    given = {one.name: one.value for one in section.values}
    assert given["plugins"] == [layer, "inflation_layer"]
    sources = str(given[f"{layer}.observation_sources"]).split()
    assert [given[f"{layer}.{source}.topic"] for source in sources] == [
        "/rover/camera/obstacles",
        "/rover/camera/ground",
    ]


# --- The ROS 2 package rtt_slam, without ROS 2: its files name each other, and its programs are ---------------------

_PACKAGE = ROOT / "rover" / "navigation"
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


def test_every_declared_program_is_installed() -> None:
    """CMake makes the programs from a list of commands: those that declare a node, with all of the launch files."""
    text = (_PACKAGE / "CMakeLists.txt").read_text(encoding="utf-8")
    (listed,) = re.findall(r"foreach\(COMMAND\s(.*?)\)", text, re.DOTALL)
    installed = {command.replace(" ", "_") for command in re.findall(r'"([\w ]+)"', listed)}
    assert installed == set(declared_nodes())
    nodes = [node for path in _LAUNCH_FILES for node in _all_of(path, "node")]
    assert {node["exec"] for node in nodes if node["pkg"] == "rtt_slam"} <= installed


def test_the_maps_in_rviz_get_what_was_published_before() -> None:
    """RTAB-Map and the costmaps publish their maps once, for subscribers that may come later."""
    whole = yaml.safe_load((_PACKAGE / "rviz" / "rover.rviz").read_text(encoding="utf-8"))
    displays = whole["Visualization Manager"]["Displays"]
    maps = {one["Topic"]["Value"]: one["Topic"] for one in displays if one["Class"] == "rviz_default_plugins/Map"}
    assert sorted(maps) == ["global_costmap/costmap", "local_costmap/costmap", "map"]
    assert {topic["Durability Policy"] for topic in maps.values()} == {"Transient Local"}
    topics = [one.get("Topic", {}).get("Value", "") for one in displays]
    assert not [topic for topic in topics if topic.startswith("/")], "in a namespace"


def test_the_map_has_one_transform_to_odom() -> None:
    """RTAB-Map publishes map -> odom only where the filter of the map is not started."""
    for mode, publishes in (("slam", True), ("landmarks", False)):
        config = yaml.safe_load((_PACKAGE / "config" / f"rtabmap_{mode}.yaml").read_text(encoding="utf-8"))
        assert config["/**/rtabmap"]["ros__parameters"]["publish_tf"] is publishes
