"""A small rover whose rows are requests: of a base to the rover, and of the rover to a board."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from tempfile import mkdtemp

from linked import write_project

from roverlink.runtime import Registry, load_registry

TABLE = """\
version: 1
proto: {root: proto}
envelope: {file: asking/envelope.proto, message: asking.Envelope, oneof: payload}
ros: {package: asking_msgs}
python: {package: asking_rover}
peers: {board: {port: 6001}, base: {port: 6000}}
messages:
  - number: 1
    name: find
    proto: asking.Find
    topic: find
    direction: base_to_ros
    request: {response: found, field: id, timeout: 40ms, attempts: 40}
  - {number: 2, name: found, proto: asking.Found, topic: found, direction: ros_to_base}
  - number: 3
    name: measure
    proto: asking.Measure
    topic: measure
    direction: base_to_ros
    request: {response: measured, field: id, timeout: 40ms, attempts: 12, service: measure_rock, srv: MeasureRock}
  - {number: 4, name: measured, proto: asking.Measured, topic: measured, direction: ros_to_base}
  - number: 5
    name: grip
    proto: asking.Grip
    topic: grip
    direction: ros_to_board
    request: {response: gripped, field: id, timeout: 40ms, attempts: 40, service: grip}
  - {number: 6, name: gripped, proto: asking.Gripped, topic: gripped, direction: board_to_ros}
  - number: 7
    name: light
    proto: asking.Light
    topic: light
    direction: ros_to_board
    request: {response: lit, timeout: 40ms, attempts: 2, service: switch_light, srv: SwitchLight}
  - {number: 8, name: lit, proto: asking.Lit, topic: lit, direction: board_to_ros}
"""
_PROTO = """\
syntax = "proto3";

package asking;

message Find { uint32 id = 1; uint32 what = 2; }
message Found { uint32 id = 1; float x = 2; }
message Measure { sint64 id = 1; uint32 x = 2; }
message Measured { sint64 id = 1; float length = 2; }
message Grip { uint32 id = 1; float force = 2; }
message Gripped { uint32 id = 1; float force = 2; }
message Light { bool on = 1; }
message Lit { bool on = 1; }
"""


def write_asking_project(folder: Path, table: str = TABLE) -> Path:
    """Write the project with its generated files into a folder, and return the folder."""
    return write_project(folder, table, _PROTO, "asking")


@cache
def asking_registry() -> Registry:
    """The registry of the project; it is loaded once in a process."""
    return load_registry(write_asking_project(Path(mkdtemp(prefix="roverlink-asking-"))), "asking_rover")
