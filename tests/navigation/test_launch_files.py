"""The launch files of the package rtt_slam, expanded by the checker as ROS 2 expands them.

The command lines in `cases` come from launch and launch_ros of Humble, and from the launch file of Nav2: these were run
once, with programs that wrote down how they were started. A parameter file that launch_ros made of values is in braces.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import pytest
from golden import ROOT

from roverlink.launch_check.catalogue.catalogue_files import read_catalogue
from roverlink.launch_check.expansion.expander import Expander, Expansion, StartedNode
from roverlink.launch_check.expansion.launch_context import Packages

_CASES = sorted((Path(__file__).parent / "cases").glob("*.txt"))
_ROS_ARGUMENTS = "--ros-args"
_Meaning = tuple[list[str], dict[str, list[str]]]
"""Words before the arguments for ROS 2, and the values of each of these in their order."""


def _expanded(file: str, *arguments: str) -> Expansion:
    """Expand a launch file of the package with arguments such as ``stvl:=true``."""
    packages = read_catalogue("humble").packages.values()
    stored = {(package.name, path): file for package in packages for path, file in package.launch_files.items()}
    expander = Expander(Packages([ROOT / "navigation", ROOT / "generated" / "ros"]), _shown, stored, set())
    return expander.expand(ROOT / "navigation" / "launch" / file, dict(one.split(":=", 1) for one in arguments))


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
    assert expansion.problems == []
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
    assert given[f"{layer}.marking.topic"] == "/rover/camera/camera/depth/color/points"
