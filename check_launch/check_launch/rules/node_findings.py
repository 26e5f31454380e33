"""Findings about what a node refuses although names and types are right, or what it waits for without end."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from itertools import pairwise

from check_launch.expansion.parameter_files import UNKNOWN, GivenValue
from check_launch.misspellings import did_you_mean, is_misspelling, misspelt
from check_launch.rules.known_parameters import ParameterView
from check_launch.rules.launch_rules import (
    BadPolygon,
    MissingParameter,
    NotManaged,
    PluginTwice,
    RefusedArguments,
    WrongLength,
    as_warning,
)
from check_launch.rules.stated_facts import stated_facts
from check_launch.rules.system import RunningNode, System, of_nodes
from roverlink.generator.diagnostics import Diagnostic
from roverlink.numerals import counted

_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")
_NUMBERS = ("--x", "--y", "--z", "--roll", "--pitch", "--yaw", "--qx", "--qy", "--qz", "--qw")
_FRAMES = ("--frame-id", "--child-frame-id")
"""Options of static_transform_publisher (tf2_ros/src/static_transform_broadcaster_program.cpp)."""
_LEAST_POINTS = 3


def value_findings(view: ParameterView) -> Iterator[Diagnostic]:
    """Yield findings about values that the node refuses, and about parameters without which it does not start."""
    for given in view.given.values():
        yield from _of_length(given, view)
    yield from _of_polygons(view)
    yield from _of_needed(view)
    yield from _of_built_in_plugins(view)


def _of_length(given: GivenValue, view: ParameterView) -> Iterator[Diagnostic]:
    lengths = stated_facts().length_of(view.facts.name, given.name)
    if lengths and isinstance(given.value, list) and len(given.value) not in lengths:
        wanted = " or ".join(map(str, lengths))
        values = counted(len(given.value), "value")
        finding = WrongLength.at(given.place, f"'{given.name}' has {values}; it must have {wanted}")
        yield as_warning(finding) if stated_facts().tolerates(given.name) else finding


def _of_polygons(view: ParameterView) -> Iterator[Diagnostic]:
    for pattern in stated_facts().polygons.get(view.facts.name, []):
        for name in view.spelled(pattern, ""):
            given = view.given.get(name)
            if given is None or not isinstance(given.value, str) or given.value in ("", "[]"):
                continue
            if not _is_polygon(given.value):
                help = 'write a text such as "[[0.3, 0.2], [0.3, -0.2], [-0.3, -0.2], [-0.3, 0.2]]"'
                message = f"'{name}' is no list of at least {_LEAST_POINTS} pairs of numbers"
                finding = BadPolygon.at(given.place, message, help)
                yield as_warning(finding) if pattern == "footprint" else finding


def _is_polygon(text: str) -> bool:
    try:
        points = ast.literal_eval(text.strip())
    except (ValueError, SyntaxError, MemoryError, RecursionError):
        return False
    return (
        isinstance(points, list)
        and len(points) >= _LEAST_POINTS
        and all(isinstance(point, list) and len(point) == 2 for point in points)  # x and y
        and all(type(number) in (int, float) for point in points for number in point)
    )


def _of_needed(view: ParameterView) -> Iterator[Diagnostic]:
    """Yield findings about parameters that the node needs for each name in a list, such as the type of a polygon.

    ``{*}`` stands for each name that has other parameters: an input of twist_mux needs a priority.
    """
    for pattern, condition in stated_facts().needed.get(view.facts.name, {}).items():
        before, variable, last = re.split(r"(\{.*?\})", pattern)
        if variable == "{*}":
            names = [name for name in view.given if name.startswith(before)]
            groups = {name.removeprefix(before).partition(".")[0]: view.given[name].place for name in names}
        else:
            listed = view.given.get(variable[1:-1])
            groups = dict.fromkeys(view.names(listed.name) or (), listed.place) if listed else {}
        for group, place in groups.items():
            owner, name = before + group, before + group + last
            if name not in view.given and view.holds(condition.replace(variable, group), ""):
                yield MissingParameter.at(place, f"'{owner}' has no '{last[1:]}'", f"set '{name}'")


def _of_built_in_plugins(view: ParameterView) -> Iterator[Diagnostic]:
    """Yield a finding about libraries of behavior trees that the node loads by itself already.

    Since Jazzy, bt_navigator adds plugin_lib_names to the libraries of nav2_behavior_tree, and a node of a tree cannot
    be registered twice (nav2_bt_navigator/src/bt_navigator.cpp).
    """
    given = view.given.get("plugin_lib_names")
    declared = view.exact.get("plugin_lib_names")
    if given is None or declared is None or declared.default != [] or not isinstance(given.value, list):
        return
    twice = [name for name in given.value if name in stated_facts().tree_nodes]
    if twice:
        names = ", ".join(twice[:3]) + (", ..." if len(twice) > 3 else "")  # as many as fit a line
        message = f"{len(twice)} of these libraries are loaded already, and registered twice: {names}"
        yield PluginTwice.at(given.place, message, "list only libraries of your own")


def node_findings(system: System) -> Iterator[Diagnostic]:
    """Yield findings about arguments of programs, and about nodes that a lifecycle manager waits for."""
    for node in system.nodes:
        if node.is_static_transform:
            yield from _of_static_transform(node)
        if node.facts is not None and node.facts.name == "nav2_lifecycle_manager::LifecycleManager":
            yield from _of_lifecycle(node, system, node.view.catalogue.distribution if node.view else "")
        if node.started.package == "controller_manager" and node.started.executable == "spawner":
            yield from _of_spawner(node, system)


def _of_static_transform(node: RunningNode) -> Iterator[Diagnostic]:
    words = [*node.started.arguments]
    if "--ros-args" in words:
        words = words[: words.index("--ros-args")]
    if not words or None in words:
        return
    texts = [word for word in words if word is not None]
    at = node.started.place
    if any(word.startswith("--") for word in texts):
        if reason := _refused_options(texts):
            help = f"the options are {' '.join((*_NUMBERS, *_FRAMES))}"
            yield RefusedArguments.at(at, f"static_transform_publisher {reason}", help)
        return
    numbers = len(texts) - 2
    help = "write --x 0 --y 0 --z 0 --yaw 0 --pitch 0 --roll 0 --frame-id PARENT --child-frame-id CHILD"
    if numbers not in (6, 7):
        period = " (ROS 2 takes no period)" if _NUMBER.fullmatch(texts[-1]) else ""
        message = f"static_transform_publisher gets {counted(len(texts), 'word')}; it takes 8 or 9{period}"
        yield RefusedArguments.at(at, message, help)
        return
    wrong = next((word for word in texts[:numbers] if not _NUMBER.match(word.strip())), None)
    if wrong is not None:
        is_period = numbers == 7 and _NUMBER.fullmatch(texts[-1])  # x y z and a quaternion
        period = "; ROS 2 takes no period at the end" if is_period else ""
        message = f"with {len(texts)} words, static_transform_publisher reads '{wrong}' as a number{period}"
        yield RefusedArguments.at(at, message, help)


def _refused_options(words: list[str]) -> str:
    """Return why static_transform_publisher refuses its options; empty if it does not."""
    if unknown := [word for word in words if word.startswith("--") and word not in (*_NUMBERS, *_FRAMES)]:
        return f"has no option '{unknown[0]}'"
    given = dict(pairwise(words))
    for option in _NUMBERS:
        if option in given and not _NUMBER.match(given[option].strip()):
            return f"reads '{given[option]}' behind {option} as a number"
    missing = [option for option in _FRAMES if not given.get(option)]
    return f"needs {' and '.join(missing)}" if missing else ""


def _of_spawner(spawner: RunningNode, system: System) -> Iterator[Diagnostic]:
    """Yield a finding about a controller that the parameters of no controller manager have."""
    name = next((word for word in spawner.started.arguments if word), "")
    given = [one.name for node in system.nodes if node.view is not None for one in node.view.given.values()]
    known = {one.removesuffix(".type") for one in given if one.endswith(".type")}
    if name not in known and (near := misspelt(name, known)):
        message = f"the spawner loads the controller '{name}', which no controller manager has"
        yield RefusedArguments.at(spawner.started.place, message, did_you_mean(near))


def _of_lifecycle(manager: RunningNode, system: System, distribution: str) -> Iterator[Diagnostic]:
    given = manager.view.given.get("node_names") if manager.view else None
    if given is None or given.value is UNKNOWN or not isinstance(given.value, list):
        return
    running = {node.name: node for node in system.nodes if node.has_known_name}
    for name in map(str, given.value):
        node = running.get(name.rpartition("/")[2])
        waits = f"{manager.name} waits for '{name}' without end"
        if node is None:
            near = [other for other in running if is_misspelling(name, other) and other not in given.value]
            if near:
                message = f"{waits}: no node has this name"
                yield as_warning(NotManaged.at(given.place, message, did_you_mean(sorted(near))))
        elif {node.started.package, f"{node.started.package}@{distribution}"} & set(stated_facts().without_lifecycle):
            message = f"{waits}: it has no lifecycle"
            finding = NotManaged.at(given.place, message, "remove it from node_names; it starts by itself")
            yield of_nodes(finding, manager, node)
