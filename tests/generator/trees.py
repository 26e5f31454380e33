"""Trees of .proto files as teams have them that never had a table, and what changes such files."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

# One file with everything, no package, names in camelCase, and comments that say who talks to whom.
FLAT = {
    "messages.proto": """
syntax = "proto3";

// Sent by the arm board, ten times a second.
message ArmJoints {
  float baseAngle = 1;  // [rad]
  float elbowAngle = 2;
  map<string, float> extras = 3;
}

// To the drive board.
message Wheels { sint32 left = 1; sint32 right = 2; }
message Note { string text = 1; }

message Envelope {
  oneof content {
    ArmJoints joints = 1;
    Wheels wheels = 3;
    Note note = 4;  // from the ground station
  }
}
"""
}

# A folder a board, packages, and an envelope that holds its oneof and nothing else; a number was used and taken away.
PACKAGES_BEFORE = {
    "rover/v1/sensor_board/imu.proto": """
syntax = "proto3";
package rover.v1.sensor_board;
message ImuReading { float accel_x = 1; float accel_y = 2; }
""",
    "rover/v1/sensor_board/ph.proto": """
syntax = "proto3";
package rover.v1.sensor_board;
message PhReading { float ph = 1; }
""",
    "rover/v1/ground_station/drive.proto": """
syntax = "proto3";
package rover.v1.ground_station;
message DriveCommand { float speed = 1; Gear gear = 2; }
enum Gear { GEAR_UNSPECIFIED = 0; GEAR_FORWARD = 1; }
""",
    "rover/v1/envelope.proto": """
syntax = "proto3";
package rover.v1;
import "rover/v1/ground_station/drive.proto";
import "rover/v1/sensor_board/imu.proto";
import "rover/v1/sensor_board/ph.proto";
message Packet {
  oneof payload {
    sensor_board.ImuReading imu = 1;
    sensor_board.PhReading ph = 2;
    ground_station.DriveCommand drive = 3;
  }
}
""",
}
_WITHOUT_PH = PACKAGES_BEFORE["rover/v1/envelope.proto"].replace("    sensor_board.PhReading ph = 2;\n", "")
PACKAGES = {
    **PACKAGES_BEFORE,
    "rover/v1/envelope.proto": _WITHOUT_PH.replace('import "rover/v1/sensor_board/ph.proto";\n', ""),
}

# An envelope with members beside its oneof, and files that collide, do not compile, or need one that does not.
_COLLIDING = {
    "envelope.proto": """\
import "motor.proto";
import "gps.proto";
message PBEnvelope {
  uint32 sequence = 1;
  oneof payload {
    MotorStatus motor_status = 2;
    MotorCommand motor_command = 3;
    GpsFix gps = 4;
    string log = 5;
  }
  reserved 9;
}
""",
    "motor.proto": """\
enum State { IDLE = 0; BUSY = 1; }
message MotorStatus { State state = 1; repeated float currents = 2; }
message MotorCommand { float power = 1; }
""",
    "gps.proto": "message GpsFix { double latitude = 1; double longitude = 2; }\n",
    "legacy.proto": "message MotorStatus { float rpm = 1; }\n",
    "other_states.proto": "enum Phase { IDLE = 0; RUNNING = 1; }\n",
    "lost.proto": 'import "nowhere.proto";\nmessage Lost { Nowhere where = 1; }\n',
    "needs_legacy.proto": 'import "legacy.proto";\nmessage Holder { MotorStatus status = 1; }\n',
}
COLLIDING = {path: f'syntax = "proto3";\n{text}' for path, text in _COLLIDING.items()}


def plant(root: Path, files: dict[str, str]) -> Path:
    """Write a tree."""
    for path, text in files.items():
        target = root / path
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(text.lstrip(), encoding="utf-8")
    return root


def commit(folder: Path, message: str) -> None:
    """Commit all there is in a folder, which becomes a repository where it is none."""
    who = {f"GIT_{role}_{what}": "a@example.com" for role in ("AUTHOR", "COMMITTER") for what in ("NAME", "EMAIL")}
    when = {"GIT_AUTHOR_DATE": "2026-03-01T12:00:00Z", "GIT_COMMITTER_DATE": "2026-03-01T12:00:00Z"}
    alone = {"GIT_CONFIG_GLOBAL": os.devnull, "GIT_CONFIG_SYSTEM": os.devnull}
    commands = [["add", "."], ["commit", "--quiet", "-m", message]]
    for command in commands if (folder / ".git").exists() else [["init", "--quiet", "-b", "main"], *commands]:
        subprocess.run(["git", *command], cwd=folder, env={**os.environ, **who, **when, **alone}, check=True)


def edit(file: Path, old: str, new: str, count: int = -1) -> None:
    """Replace a text that a file has."""
    text = file.read_text(encoding="utf-8")
    assert old in text, old
    file.write_text(text.replace(old, new, count), encoding="utf-8")
