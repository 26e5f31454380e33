"""The hash of a row says whether two ends read its bytes in the same way, and says nothing else."""

from __future__ import annotations

import hashlib
from pathlib import Path

from declarations.descriptors import compiled
from google.protobuf.descriptor_pb2 import FileDescriptorSet
from trees import plant

from roverlink.generator.protos.descriptors import schema_of
from roverlink.generator.protos.row_hash import row_hash

_FILES = {
    "a.proto": """\
syntax = "proto3";
package p;
import "b.proto";
message Payload {
  int32 a = 1;
  repeated float b = 2;
  Inner held = 6;
  oneof choice {
    bool c = 3;
    string d = 4;
  }
}
""",
    "b.proto": """\
syntax = "proto3";
package p;
message Inner {
  int32 a = 1;
  repeated float b = 2;
  repeated Innermost held = 6;
}
message Innermost {
  double x = 1;
  Mode mode = 2;
  map<string, uint32> counts = 3;
}
enum Mode {
  IDLE = 0;
  DRIVE = 1;
}
message Unrelated { int32 a = 1; UnrelatedMode mode = 2; }
enum UnrelatedMode { UNRELATED = 0; }
""",
}


def _hash(folder: Path, files: dict[str, str], payload: str = "p.Payload") -> int:
    plant(folder, files)
    descriptors = compiled(folder, "a.proto")
    assert descriptors, files
    return row_hash(schema_of(FileDescriptorSet(file=descriptors), ""), payload)


_SAME = {
    "a.proto": """\
syntax = "proto3";
package p;
import "b.proto";
// The payload.
message Payload {
  oneof choice { string d = 4; bool c = 3; }
  Inner held = 6;  // what it holds
  reserved 300 to 310;
  repeated float b = 2;
  int32 a = 1;
  reserved "gone";
}
message Inner { repeated float b = 2; repeated Innermost held = 6; int32 a = 1; option deprecated = true; }
message Unrelated { string other = 2; }
""",
    "b.proto": """\
syntax = "proto3";
package p;
enum Mode { IDLE = 0; DRIVE = 1; reserved 7; }
message Innermost { map<string, uint32> counts = 3; Mode mode = 2; double x = 1; }
""",
}


def test_nothing_else_changes_the_hash(tmp_path: Path) -> None:
    """The order of declarations, their files, comments, reserved numbers and other messages leave the hash alone."""
    assert _hash(tmp_path, _SAME) == _hash(tmp_path, _FILES)


def test_the_hash_is_that_of_the_documented_text(tmp_path: Path) -> None:
    """A program without roverlink can compute the hash from the text that the module documents."""
    file = """\
syntax = "proto2";
package p;
message Payload {
  optional Mode mode = 3;
  required float speed = 1;
  repeated Part parts = 2;
  oneof choice { uint32 count = 4; }
  optional int32 level = 5 [default = 7];
}
message Part {
  repeated Joint joints = 1;
  map<string, uint32> counts = 2;
  oneof side { bool left = 3; }
}
message Joint { optional double angle = 1; optional State state = 2; }
enum State { UNKNOWN = 0; }
enum Mode { IDLE = 0; DRIVE = -1; }
"""
    text = (
        "p.Payload\nmessage p.Joint\n1 angle double optional\n2 state p.State optional\n"
        "message p.Part\n1 joints p.Joint repeated\n2 counts p.Part.CountsEntry repeated\n3 left bool in side\n"
        "message p.Part.CountsEntry\n1 key string optional\n2 value uint32 optional\n"
        "message p.Payload\n1 speed float required\n2 parts p.Part repeated\n"
        '3 mode p.Mode optional\n4 count uint32 in choice\n5 level int32 optional default="7"\n'
        "enum p.Mode\n-1 DRIVE\n0 IDLE\nenum p.State\n0 UNKNOWN\n"
    )
    assert _hash(tmp_path, {"a.proto": file}) == int.from_bytes(hashlib.sha256(text.encode()).digest()[:4], "big")
