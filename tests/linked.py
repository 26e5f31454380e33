"""A small rover whose table has the link message: two boards, a basestation, and a row that is forwarded."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from tempfile import mkdtemp

from roverlink.generator.pipeline import compile_table
from roverlink.runtime import Registry, load_registry

TABLE = """\
version: 1
proto: {root: proto}
envelope: {file: linked/envelope.proto, message: linked.Envelope, oneof: payload}
ros: {package: linked_msgs}
python: {package: linked_rover}
peers:
  hardware: {prefixes: [Arm, Drive], port: 6001}
  base: {prefixes: [Base], port: 6000}
link: {number: 20}
messages:
  - {number: 1, name: arm_state, proto: linked.ArmState, topic: arm_state, direction: hardware_to_ros, forward: [base]}
  - {number: 2, name: drive_state, proto: linked.DriveState, topic: drive_state, direction: hardware_to_ros}
  - {number: 3, name: drive_command, proto: linked.DriveCommand, topic: drive_command, direction: ros_to_hardware}
  - {number: 4, name: mode, proto: linked.BaseMode, topic: mode, direction: base_to_ros}
  - {number: 5, name: map, proto: linked.BaseMap, topic: map, direction: ros_to_base}
"""
PROTO = """\
syntax = "proto3";

package linked;

message ArmState { float angle = 1; }
message DriveState { float speed = 1; }
message DriveCommand { float speed = 1; }
message BaseMode { uint32 mode = 1; }
message BaseMap { float x = 1; }
"""


def write_project(folder: Path, table: str = TABLE, proto: str = PROTO, name: str = "linked") -> Path:
    """Write the project with its generated files into a folder, and return the folder.

    ``name`` is the folder of its protos: two projects in one process need two names.
    """
    (folder / "proto" / name).mkdir(parents=True)
    (folder / "mapping.yaml").write_text(table, encoding="utf-8")
    (folder / "proto" / name / "messages.proto").write_text(proto, encoding="utf-8")
    for path, text in compile_table(folder / "mapping.yaml").files.items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text(text, encoding="utf-8")
    return folder


@cache
def linked_registry() -> Registry:
    """The registry of the project; it is loaded once in a process."""
    return load_registry(write_project(Path(mkdtemp(prefix="roverlink-linked-"))), "linked_rover")
