"""Facts about this project's own programs for the check of launch files, read from the project's code and table.

The programs are the commands of roverlink, which the package rtt_slam installs for launch files, and the bridge of the
generated interface package.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from check_launch.catalogue.facts import (
    OWN_SOURCE,
    Catalogue,
    Endpoint,
    NodeClass,
    Package,
    Parameter,
    Source,
    Transform,
)
from roverlink.generator.diagnostics import Diagnostic, DiagnosticsError
from roverlink.generator.node_parameters import node_parameters
from roverlink.generator.table import reader
from roverlink.generator.table.keys import PeerSettings, Row, Table

PACKAGE = "rtt_slam"
"""ROS 2 package that installs commands of roverlink as programs: ``aruco_track`` is ``roverlink aruco track``."""
_HERE = Path(__file__).parent
_TYPES = {"STRING": "string", "DOUBLE": "double", "INTEGER": "integer", "BOOL": "bool"}
_TABLE_LINE = re.compile(r"^\| *(\S+) *\| *(.+?) *\| *(.+?) *\|$", re.MULTILINE)
_IMAGES = "images of the source"
"""Stands for the topic in the argument ``topic:NAME``. No parameter can have this name."""
_SIM_TIME = {"use_sim_time": Parameter("bool", False)}


@dataclass(frozen=True, slots=True)
class _Program:
    """A command of roverlink that is a node."""

    modules: tuple[str, ...] = ()
    """Modules whose documentation has a table of topics."""
    parameters: tuple[str, str] | None = None
    """Module and variable with the types of the parameters; None if the node has none of its own."""
    prefix: str = ""
    """Beginning of the parameters' names."""
    transforms: tuple[Transform, ...] = ()
    takes_images: bool = False
    """True if the first argument may be ``topic:NAME``, a topic with images."""


_PROGRAMS: Mapping[str, _Program] = {
    "aruco_track": _Program(
        ("vision/ros/publishing.py", "vision/ros/rover_pose.py"),
        ("aruco/target_parameters.py", "_DESCRIPTIONS"),
        takes_images=True,
    ),
    "drive": _Program(("drive/driving.py",), ("drive/drive_parameters.py", "PARAMETERS")),
    "mission_run": _Program(("mission/mission_running.py",)),
    "odometry": _Program(
        ("odometry/wheel_odometry_node.py",),
        ("odometry/odometry_parameters.py", "PARAMETERS"),
        transforms=(Transform("$(odom_frame)", "$(base_frame)", "$(publish_tf)"),),
    ),
    "objects_select": _Program(("objects/selecting.py",)),
    "objects_track": _Program(("objects/object_tracking.py",), takes_images=True),
    "video_send": _Program((), ("video/stream_parameters.py", "_DESCRIPTIONS"), "{*}.", takes_images=True),
}
"""Programs by the names of their executables."""


def with_own_programs(catalogue: Catalogue, table_file: Path | None) -> Catalogue:
    """Return a catalogue that has also the programs of this project.

    ``table_file`` is the project's mapping.yaml; without it, there is no bridge.
    """
    table = _table(table_file) if table_file else None
    rows = {row.topic: row for row in table.rows} if table else {}
    package = table.ros.package if table else ""
    classes = {f"{PACKAGE}::{name}": _node(name, one, rows, package) for name, one in _PROGRAMS.items()}
    executables = {name: f"{PACKAGE}::{name}" if name in _PROGRAMS else "" for name in sorted(_commands())}
    packages = {PACKAGE: Package(PACKAGE, "", OWN_SOURCE, executables, (), {})}
    if table:
        classes[f"{package}::{package}_node"] = _bridge(table)
        packages[package] = Package(package, "", OWN_SOURCE, {f"{package}_node": f"{package}::{package}_node"}, (), {})
    return replace(
        catalogue,
        sources={**catalogue.sources, OWN_SOURCE: Source("roverlink", "", "")},
        packages={**catalogue.packages, **packages},
        classes={**catalogue.classes, **classes},
    )


def _commands() -> Iterator[str]:
    """Yield the names of all commands, with ``_`` between the words of commands of a group."""
    for path in (_HERE / "commands").rglob("*.py"):
        if path.stem != "__init__":
            yield "_".join(path.relative_to(_HERE / "commands").with_suffix("").parts)


def _table(path: Path) -> Table | None:
    """Read the table; None if it cannot be read, which other commands report."""
    findings: list[Diagnostic] = []
    try:
        return reader.read(path, findings)
    except (DiagnosticsError, OSError):
        return None


def _node(name: str, program: _Program, rows: Mapping[str, Row], package: str) -> NodeClass:
    parameters = dict(_SIM_TIME)
    if program.parameters:
        parameters |= {program.prefix + key: one for key, one in _parameters(*program.parameters)}
    endpoints = [one for module in program.modules for one in _topics(_HERE / module, rows, package)]
    if program.takes_images:
        endpoints.append(Endpoint("subscription", f"$({_IMAGES})", "sensor_msgs/msg/Image", needed="true"))
        parameters[_IMAGES] = Parameter("string", "")
    arguments = {"topic:": _IMAGES} if program.takes_images else {}
    return NodeClass(
        f"{PACKAGE}::{name}",
        default_name=_constant(_HERE / "commands" / f"{name.replace('_', '/')}.py", "NODE"),
        parameters=parameters,
        endpoints=tuple(endpoints),
        transforms=program.transforms,
        arguments=arguments,
    )


def _topics(path: Path, rows: Mapping[str, Row], package: str) -> Iterator[Endpoint]:
    """Yield the topics in the table of a module's documentation; ``received`` in the last column says the direction."""
    for name, types, content in _TABLE_LINE.findall(_documentation(path)):
        if "<" in name or name == "topic" or name.startswith(("-", "/tf")):
            continue
        kind = "subscription" if "received" in content else "publisher"
        if "row" in types:
            yield Endpoint(kind, name, _type_of_row(rows[name], package) if name in rows else "")
        else:
            yield from (Endpoint(kind, name, one.strip().replace("/", "/msg/")) for one in types.split(","))


def _constant(path: Path, name: str) -> str:
    """Return the text that a module gives to a constant."""
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.Assign) and any(isinstance(one, ast.Name) and one.id == name for one in node.targets):
            return str(ast.literal_eval(node.value))
    return ""


def _documentation(path: Path) -> str:
    return ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or ""


def _parameters(module: str, variable: str) -> Iterator[tuple[str, Parameter]]:
    """Yield the parameters in a dictionary of a module, with their types: the constants of `ParameterValue`.

    The module is read and not imported: some of them need OpenCV.
    """
    tree = ast.parse((_HERE / module).read_text(encoding="utf-8"))
    constants: dict[str, str] = {}
    for node in ast.walk(tree):
        if (
            isinstance(node, ast.Assign)
            and isinstance(node.targets[0], ast.Tuple)
            and isinstance(node.value, ast.Tuple)
        ):
            for target, value in zip(node.targets[0].elts, node.value.elts, strict=False):
                if isinstance(target, ast.Name) and isinstance(value, ast.Attribute):
                    constants[target.id] = value.attr
    for node in tree.body:
        targets = (
            node.targets if isinstance(node, ast.Assign) else [node.target] if isinstance(node, ast.AnnAssign) else []
        )
        named = any(isinstance(one, ast.Name) and one.id == variable for one in targets)
        if named and isinstance(node, ast.Assign | ast.AnnAssign) and isinstance(node.value, ast.Dict):
            for key, value in zip(node.value.keys, node.value.values, strict=True):
                if isinstance(key, ast.Constant) and isinstance(value, ast.Tuple):
                    first = value.elts[0] if len(value.elts) > 2 else None  # the default, if there is one
                    given = first.value if isinstance(first, ast.Constant) else None
                    default = given if isinstance(given, str | int | float) else None
                    yield str(key.value), Parameter(_type_of(value, constants), default)


def _type_of(value: ast.Tuple, constants: Mapping[str, str]) -> str:
    for one in value.elts:
        name = (
            one.attr
            if isinstance(one, ast.Attribute)
            else constants.get(one.id, "") if isinstance(one, ast.Name) else ""
        )
        if name in _TYPES:
            return _TYPES[name]
    return ""


def _type_of_row(row: Row, package: str) -> str:
    """Return the type of a row's message, such as ``comms/msg/DrivingBoardMotorMessage``."""
    return row.ros.replace("/", "/msg/") if "/" in row.ros else f"{package}/msg/{row.ros}"


def _bridge(table: Table) -> NodeClass:
    """Return the facts about the bridge: a topic for each row, and the parameters of the table."""
    package = table.ros.package
    endpoints = []
    for row in table.rows:
        kind = "publisher" if row.direction.endswith("_to_ros") else "subscription"
        endpoints.append(Endpoint(kind, row.topic, _type_of_row(row, package), row.qos.reliability, row.qos.durability))
        endpoints += [
            Endpoint(kind, also.topic, also.ros.replace("/", "/msg/"), also.qos.reliability, also.qos.durability)
            for also in row.also
        ]
    parameters = {
        name: Parameter(_parameter_type(one["default"]), one["default"]) for name, one in node_parameters().items()
    }
    for peer in table.peers:
        parameters |= dict.fromkeys(_port_parameters(peer), Parameter("integer"))
        parameters |= dict.fromkeys(_host_parameters(peer), Parameter("string"))
    return NodeClass(
        f"{package}::{package}_node",
        default_name="udp_forwarder",
        parameters={**_SIM_TIME, **parameters},
        endpoints=tuple(endpoints),
    )


def _parameter_type(default: object) -> str:
    return {bool: "bool", int: "integer", float: "double"}.get(type(default), "string")


def _port_parameters(peer: PeerSettings) -> list[str]:
    return [f"{peer.name}_{board.name}_port" for board in peer.boards] or [peer.parameter]


def _host_parameters(peer: PeerSettings) -> list[str]:
    return [f"{peer.name}_{board.name}_host" for board in peer.boards] or [f"{peer.name}_host"] * bool(peer.host)
