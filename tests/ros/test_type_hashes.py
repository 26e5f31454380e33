"""Type hashes: those that ROS 2 has published, and those that an independent implementation computes.

rosidl's own computation came with Iron; where a ROS 2 as new as that is sourced, `make ros-package` compares with it.
"""

from __future__ import annotations

import dataclasses
import pkgutil
import re
from functools import cache
from importlib import import_module
from typing import Any, ClassVar

import pytest
from case_file import CaseFile
from golden import ROOT, compiled, passing_cases
from rosbags.typesys import Stores, get_typestore
from rosbags.typesys.msg import get_types_from_msg

import generated.messages
from roverlink import standard_types
from roverlink.generator.emit.type_hashes import type_hashes
from roverlink.generator.ir.model import RosField, RosMessage, RosType
from roverlink.generator.pipeline import Compiled, compile_table
from roverlink.runtime import interfaces
from roverlink.runtime.core.cdr import encode
from roverlink.runtime.core.messages import Int64, Message
from roverlink.runtime.core.type_hash import service_hash, type_hash

# As ROS 2 itself shows them: in the keys of rmw_zenoh, in rosbag2's metadata, in generated code of other projects.
_PUBLISHED = {
    "std_msgs/msg/Empty": "RIHS01_20b625256f32d5dbc0d04fee44f43c41e51c70d3502f84b4a08e7a9c26a96312",
    "std_msgs/msg/String": "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18",
    "rosgraph_msgs/msg/Clock": "RIHS01_692f7a66e93a3c83e71765d033b60349ba68023a8c689a79e48078bcb5c58564",
    "sensor_msgs/msg/Imu": "RIHS01_7d9a00ff131080897a5ec7e26e315954b8eae3353c3f995c55faf71574000b5b",
}


@cache
def _own() -> Compiled:
    """The table of this repository, compiled."""
    return compile_table(ROOT / "mapping.yaml")


@pytest.mark.parametrize(
    ("name", "fields"),
    [
        ("std_msgs/msg/Empty", ()),
        ("std_msgs/msg/String", (RosField("data", RosType("string"), "a comment does not count"),)),
        ("rosgraph_msgs/msg/Clock", (RosField("clock", RosType("Time", True, package="builtin_interfaces"), ""),)),
    ],
)
def test_what_ros_2_published(name: str, fields: tuple[RosField, ...]) -> None:
    """The generator gives messages of ROS 2's own the hashes that they have there."""
    package, _, message = name.split("/")
    bridge = _own().bridge
    bridge = dataclasses.replace(bridge, package=package, messages=(RosMessage(message, fields, (), "", ""),))
    assert type_hashes(bridge) == {message: _PUBLISHED[name]}


@pytest.mark.parametrize("name", _PUBLISHED)
def test_standard_messages_have_their_hashes(name: str) -> None:
    """What `roverlink pub --type` publishes says the hash that ROS 2's own nodes say."""
    message = standard_types.message_type(name)
    assert message.__typehash__ == _PUBLISHED[name]
    assert encode(message())  # it is no field


@pytest.mark.parametrize(
    "case",
    [None, *(pytest.param(case, marks=pytest.mark.slow) for case in passing_cases())],
    ids=lambda case: case.name if case else "this_project",
)
def test_an_independent_implementation_agrees(case: CaseFile | None) -> None:
    """The package rosbags computes the same hash from the .msg texts, of every message of every golden case."""
    project = compiled(case) if case else _own()
    store: Any = get_typestore(Stores.ROS2_JAZZY)
    package = project.bridge.package
    for path, text in project.files.items():
        if match := re.fullmatch(rf"{project.bridge.folder}/ros/{package}/msg/(\w+)\.msg", path):
            store.register(get_types_from_msg(text, f"{package}/msg/{match[1]}"))
    ours = type_hashes(project.bridge)
    assert ours == {name: store.hash_rihs01(f"{package}/msg/{name}") for name in ours}


def test_the_runtime_computes_the_same() -> None:
    """The bridge, which has no generator, computes the hash of any class as the generator and rosbags have it."""
    names = [f"{interfaces.__name__}.{one.name}" for one in pkgutil.iter_modules(interfaces.__path__)]
    modules = [generated.messages, *map(import_module, names)]
    known = {one for module in modules for one in vars(module).values() if getattr(one, "__typehash__", "")}
    assert len(known) > 60
    for one in known:
        bare = type(one.__name__, (one,), {"__msgtype__": one.__msgtype__, "__typehash__": ""})
        assert type_hash(bare) == one.__typehash__


@dataclasses.dataclass
class _Request(Message):
    __msgtype__: ClassVar[str] = "example_interfaces/srv/AddTwoInts_Request"

    a: Int64 = 0
    b: Int64 = 0


@dataclasses.dataclass
class _Response(Message):
    __msgtype__: ClassVar[str] = "example_interfaces/srv/AddTwoInts_Response"

    sum: Int64 = 0


def test_services_have_hashes() -> None:
    """The hash of a service is that in the keys of rmw_zenoh's documentation."""
    assert service_hash(_Request, _Response) == (
        "RIHS01_e118de6bf5eeb66a2491b5bda11202e7b68f198d6f67922cf30364858239c81a"
    )


def test_the_classes_have_the_hashes() -> None:
    """Each generated class of this project carries its own."""
    classes = {name: getattr(generated.messages, name) for name in generated.messages.__all__}
    hashes = type_hashes(_own().bridge)
    assert {one.__msgtype__: one.__typehash__ for one in classes.values()} == {
        f"comms/msg/{name}": hash for name, hash in hashes.items()
    }
