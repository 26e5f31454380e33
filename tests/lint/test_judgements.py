"""The same meaning or another one? A table of changes, each judged alike by all options; and any names."""

from __future__ import annotations

import json
import re
from pathlib import Path
from random import Random

import pytest
from comparing import case_table
from hypothesis import given
from hypothesis import strategies as st
from repositories import RepositoryBuilder, git

from roverlink.__main__ import main
from roverlink.generator.lint.names.similar_names import Likeness, compare_names

SAME, DOUBT, OTHER = "", "warning", "error"

_NAMES = {
    # spelling, form, order, qualifier
    SAME: """
    accelX accel_x, load_cell loadcell, labels label, temp temperature, cmd_pos command_position, x_accel accel_x,
    speed motor_speed, battery_pack_voltage battery_voltage, imu_data imu_info, angle angle_deg, motor_01 motor_1,
    ids id_list, swap_bot swap_robot
    """,
    # cannot be decided
    DOUBT: """
    speed velocity, lattitude latitude, temperature tempreature, calibrate calibrated, str string,
    speed speed_limit, speed left_speed, speed max_speed, speed_min speed, uptime_min uptime_s, motor motor_2,
    value speed, range_test_plugin_enabled range_test_module_enabled, reach_mm reach_m, angle_x100 angle_x10,
    position delta_position, filepath path, batterylevel level, motorspeed speed, uid user_id, pubkey public_key,
    vote_key voting_key, substitute substitution, unset not_set, UBloxInitState UBLOX_UNIT_STATE,
    origin source, reserved_2 speed, altitude_z absolute_altitude_m
    """,
    # another meaning
    OTHER: """
    voltage temperature, left_speed left_current, imu_status gps_status,
    range_test_plugin_speed range_test_plugin_current, imu_sensor_status gps_sensor_status, light right,
    left_speed right_speed, front_distance rear_distance, temp_min temp_max, minimum maximum,
    request_id response_id, start_time stop_time, time_on time_off, read_count write_count, bytes_in bytes_out,
    up down, upper_bound lower_bound, open_angle closed_angle, enable disable, first_seen last_seen,
    accel_x accel_y, lat lon, latitude altitude, tx_bytes rx_bytes, primary_voltage secondary_voltage,
    src_address destination_address, roll pitch, pitch_rate yaw_rate, motor1 motor2, sensor_a sensor_b,
    left_speed right_wheel_speed, rover_to_board board_to_rover, left_right right_left, ready not_ready,
    leftspeed right_speed, notready ready, voltage age, discharge charge, offset set, unlock lock, account count,
    generate rate, imu_x mag_x, filename filepath
    """,
}
"""Old and new names of a float field, by the severity with which the number is reported."""
_FILES = case_table("""
repeated_to_singular | message A { repeated float x = 1; }
error | message A { float x = 1; }
singular_to_repeated | message A { int32 x = 1; }
error | message A { repeated int32 x = 1; }
other_scalar | message A { int32 x = 1; }
error | message A { float x = 1; }
wider_scalar | message A { int32 x = 1; }
- | message A { int64 x = 1; }
scalar_to_message | message A { int32 x = 1; }
error | message A { B x = 1; } message B {}
map_of_other_values | message A { map<string, int32> x = 1; }
error | message A { map<string, string> x = 1; }
map_of_wider_values | message A { map<int32, int32> x = 1; }
- | message A { map<int32, int64> x = 1; }
text_to_bytes | message A { string label = 1; }
error | message A { bytes label = 1; }
into_a_oneof | message A { float voltage = 1; float current = 2; }
error | message A { oneof supply { float voltage = 1; float current = 2; } }
json_name | message A { float voltage = 1; }
- | message A { float supply = 1 [json_name = "voltage"]; }
message_in_itself | message A { repeated A children = 1; float angle = 2; }
error | message A { repeated A children = 1; float torque = 2; }
message_in_a_map | message B { float speed = 1; } message A { map<string, B> motors = 1; }
error | message B { float torque = 1; } message A { map<string, B> motors = 1; }
values_prefixed | enum A { IDLE = 0; DRIVING = 1; DOCKING = 2; }
- | enum A { A_IDLE = 0; A_DRIVING = 1; A_DOCKING = 2; }
value_replaced | enum A { OFF = 0; MANUAL = 1; HOMING = 2; }
error | enum A { OFF = 0; CHARGING = 1; HOMING = 2; }
fields_swapped | message A { float speed = 1; float motor_speed = 2; }
error | message A { float motor_speed = 1; float speed = 2; }
field_takes_the_number_of_another | message A { float speed = 1; float motor_speed = 2; }
error | message A { float motor_speed = 1; reserved 2; }
unit_of_a_text | message A { string size_mm = 1; }
- | message A { string size_m = 1; }
type_renamed | message Wheel { float speed = 1; } message A { Wheel wheel = 1; }
- | message Tyre { float speed = 1; } message A { Tyre wheel = 1; }
type_renamed_with_its_field | message Gps { double latitude = 1; double longitude = 2; } message A { Gps gps = 1; }
warning | message Fix { double latitude = 1; double longitude = 2; } message A { Fix fix = 1; }
payload_renamed | message Gps { double latitude = 1; double longitude = 2; } message A { oneof o { Gps gps = 1; } }
- | message Fix { double latitude = 1; double longitude = 2; } message A { oneof o { Fix fix = 1; } }
payload_renamed_after_its_type | message Gps { double latitude = 1; } message A { oneof o { Gps gps = 1; } }
- | message Gps { double latitude = 1; } message A { oneof o { Gps place = 1; } }
type_of_a_few_letters | message Gyro { float x = 1; float y = 2; float z = 3; } message A { oneof o { Gyro gyro = 1; } }
error | message Accel { float x = 1; float y = 2; float z = 3; } message A { oneof o { Accel accel = 1; } }
empty_for_empty | message Ping {} message A { oneof o { Ping ping = 1; } }
error | message Reset {} message A { oneof o { Reset reset = 1; } }
empty_for_empty_under_the_same_name | message Ping {} message A { oneof o { Ping command = 1; } }
warning | message Reset {} message A { oneof o { Reset command = 1; } }
empty_renamed | message Ping {} message A { oneof o { Ping ping = 1; } }
warning | message PingRequest {} message A { oneof o { PingRequest ping = 1; } }
one_type_for_all | message Empty {} message A { oneof o { Empty ping = 1; } }
error | message Empty {} message A { oneof o { Empty reset = 1; } }
type_that_grows | message Place { float x = 1; } message A { Place arm_place = 1; }
- | message Vector { float x = 1; float y = 2; } message A { Vector place = 1; }
twin | message LeftArm { float elbow = 1; float grip = 2; } message A { oneof o { LeftArm arm = 1; } }
error | message RightArm { float elbow = 1; float grip = 2; } message A { oneof o { RightArm arm = 1; } }
one_of_two_fields | message B { float elbow = 1; float grip = 2; } message A { B arm = 1; }
error | message C { float elbow = 1; float motor_temperature = 2; } message A { C arm = 1; }
value_qualified | enum A { A_NONE = 0; A_DRIVE = 1; }
- | enum A { A_NONE = 0; A_DRIVE_MANUAL = 1; }
compound_of_a_neighbour | message A { string lidarscan = 1; string lidar_name = 2; }
warning | message A { string scan = 1; string lidar_name = 2; }
value_without_its_own_word | enum A { NO_FAULT = 0; MOTOR_FAULT = 1; BUS_FAULT = 2; ARM_FAULT = 3; }
- | enum A { NO_FAULT = 0; FAULT = 1; BUS_FAULT = 2; ARM_FAULT = 3; }
value_with_the_enum_s_prefix | enum Arm { ARM_NONE = 0; ARM_OPEN = 1; } message A { Arm arm = 1; }
error | enum Arm { ARM_NONE = 0; ARM_CALIBRATING = 1; } message A { Arm arm = 1; }
value_without_a_name | enum A { A_UNKNOWN = 0; }
warning | enum A { A_UNSPECIFIED = 0; }
values_swapped | enum A { A_NONE = 0; A_LEFT = 1; A_RIGHT = 2; }
error | enum A { A_NONE = 0; A_RIGHT = 1; A_LEFT = 2; }
alias_renamed | enum A { option allow_alias = true; A_NONE = 0; A_OFF = 0; }
- | enum A { option allow_alias = true; A_NONE = 0; A_IDLE = 0; }
""")
"""The old and the new content of a file, and the severity. The messages that are judged are named `A`."""
_EXTENSIONS = case_table("""
extension_renamed | extend A { optional  float speed = 100; }
- | extend A { optional  float motor_speed = 100; }
extension_replaced | extend A { optional  float speed = 100; }
error | extend A { optional  float current = 100; }
extension_retyped | extend A { optional  float speed = 100; }
error | extend A { optional  string speed = 100; }
extension_in_doubt | extend A { optional  float speed = 100; }
warning | extend A { optional  float velocity = 100; }
extension_added | extend A { optional float speed = 100; }
- | extend A { optional float speed = 100; optional int32 x = 101; }
""")
_OF_NAMES = {
    f"{old}_to_{new}": (f"message A {{ float {old} = 1; }}", f"message A {{ float {new} = 1; }}", verdict)
    for verdict, pairs in _NAMES.items()
    for old, new in (pair.split() for pair in pairs.split(","))
}
CASES = _FILES | _EXTENSIONS | _OF_NAMES
_OTHERWISE = {
    ("text_to_bytes", "--history"): SAME,  # a new program reads any text; old ones reject bytes that are not UTF-8
    ("text_to_bytes", "--against"): SAME,
    ("into_a_oneof", "--history"): SAME,
    ("into_a_oneof", "--branches"): SAME,
    ("type_that_grows", "--branches"): OTHER,  # no commit removes the one and adds the other
    ("compound_of_a_neighbour", "--branches"): OTHER,  # only the two names are looked at
}
"""Verdicts of options that see a case differently."""
_OF_MEANINGS = re.compile("WIR|HIS|PIN")
_OF_PAYLOADS = "lint protos --envelope envelope.proto --message Envelope"
_BETWEEN = "message A { float other = 9; }"


def _payload(name: str) -> str:
    return f"{name}.{'Use' if CASES[name][0].startswith('enum A') else 'A'}"


def _file(name: str, text: str) -> str:
    if name in _EXTENSIONS:
        return f'syntax = "proto2";\npackage {name};\nmessage A {{ extensions 100 to 199; }}\n{text}\n'
    use = "message Use { repeated A a = 1; }\n" if _payload(name).endswith("Use") else ""
    return f'syntax = "proto3";\npackage {name};\n{text}\n{use}'


def _states(side: int) -> dict[str, str]:
    imports = "".join(f'import "{name}.proto";\n' for name in CASES)
    members = " ".join(f"{_payload(name)} {name.lower()} = {number};" for number, name in enumerate(CASES, 1))
    link = f'syntax = "proto3";\n{imports}message Envelope {{ oneof payload {{ {members} }} }}\n'
    files = {f"protos/{name}.proto": _file(name, case[side]) for name, case in CASES.items()}
    return {"protos/envelope.proto": link, **files}


def _verdicts(capsys: pytest.CaptureFixture[str], command: str) -> dict[str, str]:
    """The gravest severity of the findings in each case; hints do not count."""
    main([*command.split(), "--format", "json"])
    verdicts = dict.fromkeys(CASES, SAME)
    for one in json.loads(capsys.readouterr().out):
        if _OF_MEANINGS.match(one["id"]) and one["severity"] != "hint":
            name = one["message_type"].split(".")[0]
            verdicts[name] = max([verdicts[name], one["severity"]], key=[SAME, DOUBT, OTHER].index)
    return verdicts


@pytest.fixture(scope="module")
def neighbours(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A repository that has the old state of all cases and then the new one, and pins to both."""
    builder = RepositoryBuilder(tmp_path_factory.mktemp("protos") / "repository")
    root = builder.commits(_states(0), _states(1)).write()
    (root / "pins.txt").write_text("arm main~1\nrover main\n")
    return root


@pytest.fixture(scope="module")
def branches(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A repository in which two open branches add the old state and the new one."""
    builder = RepositoryBuilder(tmp_path_factory.mktemp("protos") / "repository")
    builder.commit("Begin", {"README.md": "Text."})
    for side in (0, 1):
        builder.branch(f"side{side}", 1)
        builder.commit("Add", _states(side), branch=f"side{side}")
    root = builder.write()
    git(root, "checkout", "--quiet", "side0")
    return root


@pytest.mark.slow
@pytest.mark.parametrize(
    "command",
    [
        "lint --history protos",
        "lint protos --against HEAD~1",
        f"{_OF_PAYLOADS} --pins pins.txt",
        f"{_OF_PAYLOADS} --branches",
    ],
)
def test_each_change_is_judged_by_its_meaning(
    neighbours: Path, branches: Path, command: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Another meaning is an error and a doubtful one a warning, in whatever way one asks."""
    monkeypatch.chdir(branches if "--branches" in command else neighbours)
    expected = {name: case[2] for name, case in CASES.items()}
    expected |= {name: verdict for (name, option), verdict in _OTHERWISE.items() if option in command}
    assert _verdicts(capsys, command) == expected


@pytest.mark.slow
def test_years_apart(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """The history judges two names alike if the number was unused between them."""
    between = {f"protos/{name}.proto": _file(name, _BETWEEN) for name in _OF_NAMES}
    monkeypatch.chdir(RepositoryBuilder(tmp_path / "repository").commits(_states(0), between, _states(1)).write())
    found = _verdicts(capsys, "lint --history protos")
    assert {name: found[name] for name in _OF_NAMES} == {name: case[2] for name, case in _OF_NAMES.items()}


def test_a_chain_of_doubts_is_not_certain(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Where each step is a doubt, its two ends are no more than that."""
    names = ("speed", "velocity", "vel_limit")
    states = [{"a.proto": f'syntax = "proto3"; message A {{ float {name} = 1; }}'} for name in names]
    root = RepositoryBuilder(tmp_path / "repository").commits(*states).write()
    main(["lint", "--history", str(root), "--format", "json"])
    assert [(one["id"], one["severity"]) for one in json.loads(capsys.readouterr().out)] == [("HIS105", "warning")]


# --- what holds for any names ---

_QUALIFIERS = st.lists(st.sampled_from(["motor", "wheel", "arm", "battery", "pack", "camera", "gripper"]), max_size=3)
_QUANTITIES = ["speed", "voltage", "temperature", "pressure", "humidity", "torque", "brightness"]
_WORD = st.sampled_from(
    [*_QUANTITIES, "left", "x", "1", "max", "temp", "mm", "of", "states", "status", "velocity", "speedy", "speeed"]
)
_NAME = st.lists(_WORD, min_size=1, max_size=4).map("_".join)
_OPPOSITES = """
left right, front rear, front back, min max, request response, start stop, on off, read write, in out, up down,
upper lower, open close, enable disable, first last, x y, y z, x z, lat lon, tx rx, primary secondary,
source destination, roll pitch, pitch yaw, roll yaw, 1 2, 3 12, a b, minimum maximum, l r, src dst
"""
_SIDES = st.sampled_from([tuple(pair.split()) for pair in _OPPOSITES.split(",")])


@pytest.mark.slow
@given(_NAME, _NAME)
def test_names_are_compared_both_ways(one: str, other: str) -> None:
    """It does not matter which of two names is the older one, and a name is like itself."""
    assert compare_names(one, other).likeness is compare_names(other, one).likeness
    assert compare_names(one, one).likeness is Likeness.SAME


def test_the_reason_is_what_a_reader_sees() -> None:
    """Codes are shown as they are written, and a number is no reason if all the rest is different, too."""
    reasons = """
    'Vector3f' (float) and 'Vector3d' (double) are not the same; 'M5STACK' and 'heltec V3' are different words;
    'P2SH' and 'tr' are different words; 'filepath' may be made of several words; '1' and '2' are not the same
    """
    pairs = "Vector3f Vector3d, M5STACK HELTEC_V3, P2SH TR, filepath path, motor1_speed motor2_speed"
    found = [compare_names(*pair.split()).reason for pair in pairs.split(",")]
    assert found == [reason.strip() for reason in reasons.split(";")]


@pytest.mark.slow
@given(_SIDES, _QUALIFIERS, _QUALIFIERS, st.sampled_from(_QUANTITIES), st.randoms())
def test_opposites_are_never_similar(
    sides: tuple[str, str], one: list[str], other: list[str], quantity: str, random: Random
) -> None:
    """Whatever words stand beside two opposites, and wherever they stand, the names are different."""
    names = [[*one, sides[0], quantity], [*other, sides[1], quantity]]
    for name in names:
        random.shuffle(name)
    assert compare_names("_".join(names[0]), "_".join(names[1])).likeness is Likeness.OPPOSITE


@given(st.sampled_from(_QUANTITIES), st.integers(1, 20), st.sampled_from("abcdefghijklmnopqrstuvwxyz"), st.booleans())
def test_one_wrong_letter_is_a_doubt(word: str, place: int, letter: str, more: bool) -> None:
    """A letter too much, or another letter in place of one, is perhaps a mistake, but never a certain change."""
    place = min(place, len(word) - 1)
    misspelt = word[:place] + letter + word[place if more else place + 1 :]
    assert compare_names(word, misspelt).likeness not in (Likeness.DIFFERENT, Likeness.OPPOSITE)
