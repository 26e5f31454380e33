"""The judgement of two states of a number: the same for neighbours (`--against`) and for years apart (`--history`)."""

from __future__ import annotations

import json
import re
from pathlib import Path
from random import Random

import pytest
from comparing import case_table
from hypothesis import assume, given
from hypothesis import strategies as st
from repositories import RepositoryBuilder

from roverlink.__main__ import main
from roverlink.generator.lint.names.similar_names import Likeness, compare_names

SAME, DOUBT, OTHER = "", "warning", "error"

_NAMES = {
    # spelling, form, order, qualifier
    SAME: """
    accelX accel_x, load_cell loadcell, labels label, temp temperature, cmd_pos command_position, x_accel accel_x,
    speed motor_speed, battery_pack_voltage battery_voltage, imu_data imu_info, angle angle_deg, motor_01 motor_1
    """,
    # cannot be decided
    DOUBT: """
    speed velocity, lattitude latitude, temperature tempreature, calibrate calibrated, str string,
    speed speed_limit, speed left_speed, speed max_speed, speed_min speed, uptime_min uptime_s, motor motor_2,
    value speed, range_test_plugin_enabled range_test_module_enabled, reach_mm reach_m, angle_x100 angle_x10,
    position delta_position
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
    left_speed right_wheel_speed, rover_to_board board_to_rover, left_right right_left, ready not_ready
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
twin | message LeftArm { float elbow = 1; float grip = 2; } message A { oneof o { LeftArm arm = 1; } }
error | message RightArm { float elbow = 1; float grip = 2; } message A { oneof o { RightArm arm = 1; } }
one_of_two_fields | message B { float elbow = 1; float grip = 2; } message A { B arm = 1; }
error | message C { float elbow = 1; float motor_temperature = 2; } message A { C arm = 1; }
value_qualified | enum A { A_NONE = 0; A_DRIVE = 1; }
- | enum A { A_NONE = 0; A_DRIVE_MANUAL = 1; }
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
_OF_MEANINGS = re.compile("WIR|HIS")


def _states(side: int) -> dict[str, str]:
    return {f"{name}.proto": _file(name, case[side]) for name, case in CASES.items()}


def _file(name: str, text: str) -> str:
    if name in _EXTENSIONS:
        return f'syntax = "proto2";\npackage {name};\nmessage A {{ extensions 100 to 199; }}\n{text}\n'
    return f'syntax = "proto3";\npackage {name};\n{text}\n'


def _verdicts(capsys: pytest.CaptureFixture[str], *arguments: str) -> dict[str, str]:
    """The gravest severity of the findings in each case; hints do not count."""
    main(["lint", *arguments, "--format", "json"])
    verdicts = dict.fromkeys(CASES, SAME)
    found = (one for one in json.loads(capsys.readouterr().out) if _OF_MEANINGS.match(one["id"]))
    for one in found:
        name = one["message_type"].split(".")[0]
        verdicts[name] = max([verdicts[name], one["severity"]], key=[SAME, "hint", DOUBT, OTHER].index)
    return {name: verdict.replace("hint", SAME) for name, verdict in verdicts.items()}


def _expected() -> dict[str, str]:
    return {name: verdict for name, (_, _, verdict) in CASES.items()}


@pytest.fixture(scope="module")
def repository(tmp_path_factory: pytest.TempPathFactory) -> str:
    """A repository that has the old state of all cases, and then the new one."""
    builder = RepositoryBuilder(tmp_path_factory.mktemp("protos") / "repository")
    builder.commit("Before", _states(0))
    builder.commit("After", _states(1))
    return str(builder.write())


def test_neighbours(repository: str, capsys: pytest.CaptureFixture[str]) -> None:
    """`lint --against` judges each case as it is to be judged."""
    assert _verdicts(capsys, repository, "--against", "HEAD~1") == _expected()


def test_the_whole_history(repository: str, capsys: pytest.CaptureFixture[str]) -> None:
    """`lint --history` gives the same judgements."""
    assert _verdicts(capsys, "--history", repository) == _expected()


def test_years_apart(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """So it does if the number was unused in between."""
    builder = RepositoryBuilder(tmp_path / "repository")
    builder.commit("Before", _states(0))
    builder.commit("Without", {f"{name}.proto": _file(name, "message A { float other = 9; }") for name in _OF_NAMES})
    builder.commit("After", _states(1))
    found = _verdicts(capsys, "--history", str(builder.write()))
    assert {name: found[name] for name in _OF_NAMES} == {name: case[2] for name, case in _OF_NAMES.items()}


def test_a_doubt_says_why(repository: str, capsys: pytest.CaptureFixture[str]) -> None:
    """Both kinds of comparison give the same reason."""
    reason = "'speed' and 'velocity' often mean the same, but not always"
    for arguments in ([repository, "--against", "HEAD~1"], ["--history", repository]):
        main(["lint", *arguments])
        assert reason in capsys.readouterr().out


def test_a_chain_of_doubts_is_not_certain(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Where each step is a doubt, its two ends are no more than that."""
    builder = RepositoryBuilder(tmp_path / "repository")
    for name in ("speed", "velocity", "vel_limit"):
        builder.commit(name, {"a.proto": _file("a", f"message A {{ float {name} = 1; }}")})
    main(["lint", "--history", str(builder.write()), "--format", "json"])
    assert [(one["id"], one["severity"]) for one in json.loads(capsys.readouterr().out)] == [("HIS105", "warning")]


# --- what holds for any names ---

_SIMILAR = (Likeness.SAME, Likeness.SIMILAR)
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


@given(_NAME, _NAME)
def test_names_are_compared_both_ways(one: str, other: str) -> None:
    """It does not matter which of two names is the older one, and a name is like itself."""
    assert compare_names(one, other).likeness is compare_names(other, one).likeness
    assert compare_names(one, one).likeness is Likeness.SAME


@given(_SIDES, _QUALIFIERS, _QUALIFIERS, st.sampled_from(_QUANTITIES), st.randoms())
def test_opposites_are_never_similar(
    sides: tuple[str, str], one: list[str], other: list[str], quantity: str, random: Random
) -> None:
    """Whatever words stand beside two opposites, and wherever they stand, the names are different."""
    names = [[*one, sides[0], quantity], [*other, sides[1], quantity]]
    for name in names:
        random.shuffle(name)
    assert compare_names("_".join(names[0]), "_".join(names[1])).likeness is Likeness.OPPOSITE


@given(_QUALIFIERS, st.sampled_from(_QUANTITIES), st.randoms())
def test_the_order_of_words_does_not_matter(qualifiers: list[str], quantity: str, random: Random) -> None:
    """The same words in another order, or in another spelling style, are the same name."""
    turned = [*qualifiers, quantity]
    random.shuffle(turned)
    assert compare_names("_".join([*qualifiers, quantity]), "_".join(turned)).likeness in _SIMILAR
    assert compare_names("_".join(turned), "".join(map(str.title, turned))).likeness in _SIMILAR


@given(_QUALIFIERS, _QUALIFIERS, st.sampled_from(_QUANTITIES))
def test_a_qualifier_keeps_the_meaning(known: list[str], added: list[str], quantity: str) -> None:
    """A name with more qualifiers is similar."""
    assert compare_names("_".join([*known, quantity]), "_".join([*known, *added, quantity])).likeness in _SIMILAR


@given(_QUALIFIERS, st.sampled_from(_QUANTITIES), st.sampled_from(_QUANTITIES))
def test_a_shared_word_is_no_similarity(qualifiers: list[str], one: str, other: str) -> None:
    """Two quantities of the same thing are different."""
    assume(one != other)
    assert compare_names("_".join([*qualifiers, one]), "_".join([*qualifiers, other])).likeness is Likeness.DIFFERENT


@given(st.sampled_from(_QUANTITIES), st.integers(1, 20), st.sampled_from("abcdefghijklmnopqrstuvwxyz"), st.booleans())
def test_one_wrong_letter_is_a_doubt(word: str, place: int, letter: str, more: bool) -> None:
    """A letter too much, or another letter in place of one, is perhaps a mistake, but never a certain change."""
    place = min(place, len(word) - 1)
    misspelt = word[:place] + letter + word[place if more else place + 1 :]
    assert compare_names(word, misspelt).likeness not in (Likeness.DIFFERENT, Likeness.OPPOSITE)
