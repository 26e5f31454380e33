"""The ROS 2 package: its .msg texts read alike everywhere, and its program and launch files start the bridge.

That it builds is for `make ros-package`, which needs ROS 2's own tools.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from golden import ROOT, compiled, passing_cases
from needs import NO_ROS

from generated.registry import REGISTRY
from roverlink.generator.ir.model import RosMessage, RosType
from roverlink.generator.pipeline import Compiled, compile_table
from roverlink.runtime import NODE
from roverlink.runtime.ros_arguments import parameters, ros_args

_SYSTEM_PYTHON = Path("/usr/bin/python3")
_EMPTY = "structure_needs_at_least_one_member"
_PACKAGE = ROOT / "generated" / "ros" / "comms"
_SOME = ("awkward_constructs", "awkward_names", "comments", "cpp_handlers", "enums")
_PROGRAM = _PACKAGE / "scripts" / "comms_node.py"


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


@pytest.mark.parametrize(
    "names",
    [pytest.param(_SOME, marks=pytest.mark.slow, id="some"), pytest.param((), marks=pytest.mark.exhaustive, id="all")],
)
def test_rosidl_reads_every_message_as_it_is_meant(names: tuple[str, ...]) -> None:
    """ROS 2's own adapter and parser find the same fields, and the constants with their values."""
    has = subprocess.run([_SYSTEM_PYTHON, "-c", "import rosidl_adapter, rosidl_parser"], capture_output=True)
    if not _SYSTEM_PYTHON.exists() or has.returncode:
        pytest.skip(NO_ROS)
    projects = {case.name: compiled(case) for case in passing_cases() if case.name in names or not names}
    projects["this project"] = compile_table(ROOT / "mapping.yaml")
    reader = [_SYSTEM_PYTHON, Path(__file__).with_name("rosidl_reads.py")]
    texts = json.dumps({name: _texts(one) for name, one in projects.items()})
    done = subprocess.run(reader, input=texts, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    said = json.loads(done.stdout.splitlines()[-1])
    for name, one in projects.items():
        for message in one.bridge.messages:
            found = said[name][f"{one.bridge.package}/{message.name}"]
            assert found["fields"] == _fields(one.bridge.package, message), (name, message.name)
            assert found["comments"] | _comments(message) == found["comments"], (name, message.name)
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
    assert f"{sys.executable} cannot run the bridge" in done.stderr
    assert "protobuf>=" in done.stderr


@pytest.mark.parametrize("namespace", ["/", "/rover"])
def test_the_file_of_parameters_is_for_the_node_in_any_namespace(namespace: str) -> None:
    """`namespace:=rover` keeps the values of params_file; config/udp.yaml has the default of every parameter."""
    ros = ros_args.parse(["--params-file", str(_PACKAGE / "config" / "udp.yaml"), "-r", f"__ns:={namespace}"], NODE)
    assert ros.parameters | {"use_sim_time": False} == parameters.defaults(REGISTRY)
