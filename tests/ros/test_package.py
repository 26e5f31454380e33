"""The ROS 2 package: its .msg texts read alike everywhere, and its program and launch files start the bridge.

That it builds is for `make ros-package`, which needs ROS 2's own tools.
"""

from __future__ import annotations

import json
import os
import re
import runpy
import subprocess
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
import yaml
from golden import ROOT, compiled, passing_cases
from needs import NO_ROS
from rosbags.typesys import Stores, get_typestore
from rosbags.typesys.msg import get_types_from_msg

from generated.registry import REGISTRY
from roverlink.generator.ir.model import RosMessage, RosType
from roverlink.generator.pipeline import Compiled, compile_table
from roverlink.runtime import NODE
from roverlink.runtime.ros_arguments import parameters, ros_args

_SYSTEM_PYTHON = Path("/usr/bin/python3")
_EMPTY = "structure_needs_at_least_one_member"
_PACKAGE = ROOT / "generated" / "ros" / "comms"
_PROGRAM = _PACKAGE / "scripts" / "comms_node.py"
_Entry = dict[str, Any]
"""An action of a YAML launch file: its kind, with its attributes."""


@pytest.fixture(scope="module")
def projects() -> dict[str, Compiled]:
    """Every golden case that compiles, and this project, by name."""
    cases = {case.name: compiled(case) for case in passing_cases()}
    return {"this project": compile_table(ROOT / "mapping.yaml"), **cases}


def _texts(one: Compiled) -> dict[str, str]:
    """Text of each .msg file, as ``package/Name``."""
    found = {path: re.fullmatch(rf"{one.bridge.folder}/ros/(\w+)/msg/(\w+)\.msg", path) for path in one.files}
    return {f"{match[1]}/{match[2]}": one.files[path] for path, match in found.items() if match}


def _fields(package: str, message: RosMessage) -> list[list[str]]:
    """Names and types of the fields that the text of a message should have."""
    return [[field.name, _type(package, field.type)] for field in message.fields] or [[_EMPTY, "uint8"]]


def _type(package: str, type: RosType) -> str:
    name = f"{type.package or package}/msg/{type.name}" if type.is_message else type.name
    return f"{name}[]" if type.is_sequence else name


@pytest.mark.slow
def test_rosbags_reads_every_message_as_it_is_meant(projects: dict[str, Compiled]) -> None:
    """An independent parser finds the fields in the texts that the generator meant, in all golden cases."""
    for folder, one in projects.items():
        store = get_typestore(Stores.ROS2_HUMBLE)
        for name, text in _texts(one).items():
            store.register(get_types_from_msg(text, name.replace("/", "/msg/")))
        for message in one.bridge.messages:
            _, found = store.fielddefs[f"{one.bridge.package}/msg/{message.name}"]
            read = [[name, _of_rosbags(kind)] for name, kind in found] or [[_EMPTY, "uint8"]]
            assert read == _fields(one.bridge.package, message), (folder, message.name)


def _of_rosbags(definition: Any) -> str:
    kind, detail = definition
    if kind.name == "SEQUENCE":
        return f"{_of_rosbags(detail[0])}[]"
    return str(detail) if kind.name == "NAME" else str(detail[0])


@pytest.mark.slow
def test_rosidl_reads_every_message_as_it_is_meant(projects: dict[str, Compiled]) -> None:
    """ROS 2's own adapter and parser find the same fields, and the constants with their values."""
    has = subprocess.run([_SYSTEM_PYTHON, "-c", "import rosidl_adapter, rosidl_parser"], capture_output=True)
    if not _SYSTEM_PYTHON.exists() or has.returncode:
        pytest.skip(NO_ROS)
    for folder, one in projects.items():
        reader = [_SYSTEM_PYTHON, Path(__file__).with_name("rosidl_reads.py")]
        done = subprocess.run(reader, input=json.dumps(_texts(one)), capture_output=True, text=True)
        assert done.returncode == 0, (folder, done.stderr)
        said = json.loads(done.stdout.splitlines()[-1])
        for message in one.bridge.messages:
            found = said[f"{one.bridge.package}/{message.name}"]
            assert found["fields"] == _fields(one.bridge.package, message), (folder, message.name)
            assert found["comments"] | _comments(message) == found["comments"], (folder, message.name)
            assert found["constants"] == [[constant.name, constant.value] for constant in message.constants]


def _comments(message: RosMessage) -> dict[str, str]:
    """The comments that rosidl takes as they are: in ASCII, of one line, no unit in brackets, no two backslashes."""
    lines = {field.name: field.comment for field in message.fields if field.comment.isascii()}
    return {name: text for name, text in lines.items() if text and not re.search(r"[\n\t\[]|\\\\", text)}


def test_the_program_of_the_package_is_the_bridge() -> None:
    """What `ros2 run comms comms_node` starts takes what `roverlink run` takes; without roverlink, it says so."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run([sys.executable, _PROGRAM, "--help"], env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "--ros-args" in done.stdout
    without = [sys.executable, "-I", "-S"]  # no packages at all
    done = subprocess.run([*without, _PROGRAM], capture_output=True, text=True)
    assert done.returncode == 2
    assert "cannot import roverlink" in done.stderr
    assert sys.executable in done.stderr


def test_the_launch_files_start_the_program_with_their_arguments(launch_in_python: list[_Entry]) -> None:
    """The Python file and the YAML file have the same arguments with descriptions, and start one node with them."""
    launch_in_yaml = yaml.safe_load((_PACKAGE / "launch" / "comms_launch.yaml").read_text(encoding="utf-8"))["launch"]
    *arguments, group = launch_in_yaml
    (params_file,) = (entry["arg"] for entry in arguments if entry["arg"]["name"] == "params_file")
    params_file["default"] = params_file["default"].replace("$(dirname)/..", str(_PACKAGE))

    assert launch_in_python == launch_in_yaml
    assert Path(params_file["default"]).is_file()
    assert all(entry["arg"]["description"] for entry in arguments)
    *overrides, node = group["group"]
    names = ["listen_address", "listen_port", "dst_ip", "dst_a_port", "dst_b_port"]
    assert [entry["set_parameter"]["name"] for entry in overrides] == names
    assert overrides[2]["set_parameter"] == {
        "name": "dst_ip",
        "value": "$(var dst_ip)",
        "if": """$(eval "'$(var dst_ip)' != ''")""",
    }
    assert node["node"] == {
        "pkg": "comms",
        "exec": "comms_node",
        "namespace": "$(var namespace)",
        "args": "--middleware $(var middleware)",
        "ros_args": "--log-level $(var log_level) --params-file $(var params_file)",
        "output": "screen",
    }


@pytest.fixture
def launch_in_python(monkeypatch: pytest.MonkeyPatch) -> list[_Entry]:
    """The description that the Python launch file returns, written in the grammar of YAML launch files."""
    grammar: dict[str, Any] = {
        "launch": {"LaunchDescription": list},
        "launch.actions": {"DeclareLaunchArgument": _declared, "GroupAction": lambda actions: {"group": actions}},
        "launch.conditions": {"IfCondition": str},
        "launch.substitutions": {
            "LaunchConfiguration": "$(var {})".format,
            "PythonExpression": lambda parts: f'$(eval "{"".join(parts)}")',
        },
        "launch_ros": {},
        "launch_ros.actions": {"Node": _node, "SetParameter": _set_parameter},
    }
    for name, content in grammar.items():
        module = ModuleType(name)
        vars(module).update(content)
        monkeypatch.setitem(sys.modules, name, module)
    path = _PACKAGE / "launch" / "comms.launch.py"
    entries: list[_Entry] = runpy.run_path(str(path))["generate_launch_description"]()
    return entries


def _declared(name: str, default_value: str, description: str) -> _Entry:
    return {"arg": {"name": name, "default": default_value, "description": description}}


def _set_parameter(name: str, value: str, condition: str) -> _Entry:
    return {"set_parameter": {"name": name, "value": value, "if": condition}}


def _node(package: str, executable: str, arguments: list[str], ros_arguments: list[str], **same: str) -> _Entry:
    args = {"args": " ".join(arguments), "ros_args": " ".join(ros_arguments)}
    return {"node": {"pkg": package, "exec": executable, **args, **same}}


@pytest.mark.parametrize("namespace", ["/", "/rover"])
def test_the_file_of_parameters_is_for_the_node_in_any_namespace(namespace: str) -> None:
    """`namespace:=rover` keeps the values of params_file; config/udp.yaml has the default of every parameter."""
    ros = ros_args.parse(["--params-file", str(_PACKAGE / "config" / "udp.yaml"), "-r", f"__ns:={namespace}"], NODE)
    assert ros.parameters == parameters.defaults(REGISTRY)
