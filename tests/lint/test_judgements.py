"""The same meaning or another one? A table of changes, each judged in five ways, all changes of a way by one command.

Each row is a type in a file of its own, and in a payload of the envelope. A verdict follows from the rules that users
read, never from what the lint prints today.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

import pytest
from folded import unfold
from repositories import RepositoryBuilder

from roverlink.__main__ import main


@dataclass(frozen=True)
class Judgement:
    """A change of a type and the numbers with a finding, as `SEVERITY NUMBER`.

    Fields alone are those of a message, which has one more field that stays. `between` is the type without what
    changes, `use` the field of a payload that has the type, if the type is no payload itself. `instead` has the verdict
    by options that see it differently.
    """

    type: str
    why: str
    before: str
    after: str
    verdict: str = ""
    between: str = ""
    use: str = ""
    instead: Mapping[str, str] = MappingProxyType({})

    @property
    def file(self) -> str:
        """Name of the type's .proto file."""
        return f"{self.type.lower()}.proto"

    def state(self, text: str) -> str:
        """Return a .proto file with one of the declarations."""
        declared = (
            text if re.search(r"\b(message|enum) ", text) else f"message {self.type} {{ {text} bool homed = 9; }}"
        )
        return unfold(declared + (f" message {self.type}Use {{ {self.use} = 1; }}" if self.use else ""))


_KEPT = "bool powered = 1; bool braked = 2; float voltage = 3; float heat = 4; float torque = 5; uint32 firmware = 6;"
_JUDGEMENTS = [
    # --- names of fields
    Judgement("Apart", "The names have no word in common.", "float voltage = 1;", "float humidity = 1;", "error 1"),
    Judgement(
        "SharedWord",
        "The names share a word, but name two quantities.",
        "float battery_voltage = 1;",
        "float battery_temperature = 1;",
        "error 1",
    ),
    Judgement(
        "Swapped",
        "Two fields swapped their numbers: each value is read as the other one.",
        "float voltage = 1; float current = 2;",
        "float current = 1; float voltage = 2;",
        "error 1, error 2",
    ),
    Judgement(
        "Opposites",
        "Names that differ by opposites are never similar.",
        f"{_KEPT} uint32 left_wheel_speed = 10; uint32 front_distance = 11; uint32 min_angle = 12;"
        " uint32 request_id = 13; uint32 start_time = 14; uint32 time_on = 15; uint32 read_count = 16; "
        "uint32 accel_x = 17; float gyro_y = 18;",
        f"{_KEPT} uint32 right_wheel_speed = 10; uint32 rear_distance = 11; uint32 max_angle = 12;"
        " uint32 response_id = 13; uint32 stop_time = 14; uint32 time_off = 15; uint32 write_count = 16;"
        " uint32 accel_y = 17; float gyro_z = 18;",
        ", ".join(f"error {number}" for number in range(10, 19)),
    ),
    Judgement("Doubtful", "A velocity may have a sign.", "float speed = 1;", "float velocity = 1;", "warning 1"),
    Judgement("Typo", "It may be a correction.", "double lattitude = 1;", "double latitude = 1;", "warning 1"),
    Judgement("Unit", "Values are wrong by 1000.", "int32 reach_mm = 1;", "int32 reach_m = 1;", "warning 1"),
    Judgement("Qualifier", "One name says more.", "float temperature = 1;", "float motor_temperature = 1;"),
    Judgement("NoQualifier", "One name says less.", "float battery_voltage = 1;", "float voltage = 1;"),
    Judgement("Spelling", "Camel or snake case.", "float motorTemperature = 1;", "float motor_temperature = 1;"),
    Judgement("Order", "The same words.", "float temperature_motor = 1;", "float motor_temperature = 1;"),
    Judgement(
        "Synonyms",
        "temp and temperature, pos and position are synonyms.",
        "float temp = 1; double pos = 2;",
        "float temperature = 1; double position = 2;",
    ),
    Judgement(
        "JsonName",
        "The new field keeps the old name as its json_name, so its author says that it is a rename.",
        "float voltage = 1;",
        'float supply = 1 [json_name = "voltage"];',
    ),
    # --- types of fields
    Judgement("Format", "The wire format changed.", "float label = 1;", "string label = 1;", "error 1"),
    Judgement("SimilarName", "So it is no mere rename.", "float angle = 1;", "string joint_angle = 1;", "error 1"),
    Judgement("Wider", "An int64 reads the same bytes.", "int32 ticks = 1;", "int64 ticks = 1;"),
    Judgement("One", "Only the last value counts.", "repeated string label = 1;", "string label = 1;", "error 1"),
    Judgement("Many", "One value became a list.", "string label = 1;", "repeated string label = 1;", "error 1"),
    Judgement(
        "Map",
        "The values of the map became another wire format.",
        "map<string, int32> counts = 1;",
        "map<string, string> counts = 1;",
        "error 1",
        instead={"--against": "error 2"},  # of the entry, which is a message
    ),
    Judgement(
        "Text",
        "Old programs reject bytes that are not UTF-8; a new one reads any text.",
        "string label = 1;",
        "bytes label = 1;",
        "error 1",
        instead={"--history": "", "--against": ""},
    ),
    Judgement(
        "Oneof",
        "A receiver keeps only the last one of two fields that could be sent together before.",
        "float voltage = 1; float current = 2;",
        "oneof supply { float voltage = 1; float current = 2; }",
        "error 1, error 2",
        instead={"--history": "", "--branches": ""},
    ),
    Judgement(
        "Joint",
        "A message that contains itself is compared once.",
        "repeated Joint children = 1; float angle = 2;",
        "repeated Joint children = 1; float torque = 2;",
        "error 2",
    ),
    Judgement(
        "Motor",
        "A message in a map is compared like any other.",
        "float speed = 1;",
        "float torque = 1;",
        "error 1",
        use="map<string, Motor> motors",
    ),
    Judgement("More", "Programs skip a field they do not know.", "float load = 1;", "float load = 1; bool ok = 4;"),
    Judgement(
        "Contents",
        "The number goes to a field of another message with other fields.",
        "message Imu { float roll = 1; float pitch = 2; float yaw = 3; } message Contents { Imu sensor = 1; }"
        " message Gps { double latitude = 1; double longitude = 2; uint32 satellites = 3; }",
        "message Imu { float roll = 1; float pitch = 2; float yaw = 3; } message Contents { Gps sensor = 1; }"
        " message Gps { double latitude = 1; double longitude = 2; uint32 satellites = 3; }",
        "error 1",
        between="message Contents { bool homed = 9; }",
    ),
    Judgement(
        "Renamed",
        "The message of the field is renamed with all its fields; the field keeps its meaning.",
        "message Pose { float tilt = 1; float pan = 2; float head = 3; } message Renamed { Pose sensor = 1; }",
        "message Attitude { float tilt = 1; float pan = 2; float head = 3; } message Renamed { Attitude sensor = 1; }",
        between="message Renamed { bool homed = 9; }",
    ),
    # --- values of enums and extensions
    Judgement(
        "Activity",
        "Number 1 of the enum meant MANUAL and means CHARGING now.",
        "enum Activity { OFF = 0; MANUAL = 1; HOMING = 2; }",
        "enum Activity { OFF = 0; CHARGING = 1; HOMING = 2; }",
        "error 1",
        between="enum Activity { OFF = 0; HOMING = 2; }",
        use="repeated Activity activities",
    ),
    Judgement(
        "Mode",
        "The values of the enum get a prefix; they keep their meaning.",
        "enum Mode { IDLE = 0; DRIVING = 1; DOCKING = 2; }",
        "enum Mode { MODE_IDLE = 0; MODE_DRIVING = 1; MODE_DOCKING = 2; }",
        between="enum Mode { IDLE = 0; }",
        use="Mode mode",
    ),
    Judgement(
        "Command",
        "The numbers of opposites are exchanged: start and stop are never similar.",
        "enum Command { COMMAND_NONE = 0; COMMAND_START = 1; COMMAND_STOP = 2; }",
        "enum Command { COMMAND_NONE = 0; COMMAND_STOP = 1; COMMAND_START = 2; }",
        "error 1, error 2",
        between="enum Command { COMMAND_NONE = 0; }",
        use="Command command",
    ),
    Judgement(
        "Arm",
        "ON and OFF are never similar.",
        "enum Arm { ARM_NONE = 0; ARM_ON = 1; ARM_HOLD = 2; }",
        "enum Arm { ARM_NONE = 0; ARM_OFF = 1; ARM_HOLD = 2; }",
        "error 1",
        between="enum Arm { ARM_NONE = 0; ARM_HOLD = 2; }",
        use="Arm arm",
    ),
    Judgement(
        "Base",
        "The extension number 100 was a voltage and is a humidity now.",
        'syntax = "proto2"; message Base { extensions 100 to 199; } extend Base { optional float voltage = 100; }',
        'syntax = "proto2"; message Base { extensions 100 to 199; } extend Base { optional float humidity = 100; }',
        "error 100",
        between='syntax = "proto2"; message Base { extensions 100 to 199; }',
    ),
    Judgement(
        "Head",
        "The extension keeps its number, its type and its meaning.",
        'syntax = "proto2"; message Head { extensions 100 to 199; } extend Head { optional float temp = 100; }',
        'syntax = "proto2"; message Head { extensions 100 to 199; } extend Head { optional float temperature = 100; }',
        between='syntax = "proto2"; message Head { extensions 100 to 199; }',
    ),
]


_PAYLOADS = [row.type + "Use" if row.use else row.type for row in _JUDGEMENTS]
_ENVELOPE = unfold(
    "".join(f'import "{row.file}"; ' for row in _JUDGEMENTS)
    + "message Envelope { oneof payload { "
    + " ".join(f"{payload} {payload.lower()} = {number};" for number, payload in enumerate(_PAYLOADS, 1))
    + " } }"
)
_OF_PAYLOADS = "lint protos --envelope envelope.proto --message Envelope"


@pytest.mark.parametrize(
    ("command", "states"),
    [
        pytest.param("lint --history protos", ["before", "after"], id="states that follow each other"),
        pytest.param("lint --history protos", ["before", "between", "after"], id="years apart"),
        pytest.param("lint protos --against HEAD~1", ["before", "after"], id="compared by --against"),
        pytest.param(f"{_OF_PAYLOADS} --pins pins.txt", ["before", "after"], id="pinned by two programs"),
        pytest.param(f"{_OF_PAYLOADS} --branches", ["between", "before", "after"], id="on two open branches"),
    ],
)
def test_each_change_is_judged_by_its_meaning(
    command: str,
    states: list[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """A number with another meaning is an error, one with a doubtful meaning a warning, in whatever way one asks."""
    repository = RepositoryBuilder(tmp_path / "repository")
    for index, name in enumerate(states):
        files = {f"protos/{row.file}": row.state(getattr(row, name)) for row in _JUDGEMENTS}
        branch = name if "--branches" in command and index else "main"
        if branch != "main":
            repository.branch(branch, 1)
        repository.commit("Change", {"protos/envelope.proto": _ENVELOPE, **files}, branch=branch)
    monkeypatch.chdir(repository.write())
    Path("pins.txt").write_text("arm main~1\nrover main\n")
    main([*command.split(), "--format", "json"])
    said = capsys.readouterr()
    assert said.err == ""
    judged: dict[str, set[str]] = {row.type: set() for row in _JUDGEMENTS}
    for one in json.loads(said.out):
        if one["severity"] != "hint":
            judged[one["message_type"].partition(".")[0]].add(f"{one['severity']} {one['number']}")
    wrong = {}
    for row in _JUDGEMENTS:
        verdict = next((row.instead[option] for option in row.instead if option in command), row.verdict)
        if judged[row.type] != set(filter(None, verdict.split(", "))):
            wrong[row.type] = f"{row.why} Judged {judged[row.type]}, not {verdict!r}."
    assert wrong == {}
