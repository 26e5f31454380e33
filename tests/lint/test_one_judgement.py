"""The judgement of two states of a number: the same for neighbours (`--against`) and for years apart (`--history`)."""

from __future__ import annotations

import json
import re
from pathlib import Path
from random import Random

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from repositories import RepositoryBuilder, git

from roverlink.__main__ import main
from roverlink.generator.lint.names.similar_names import Likeness, compare_names

SAME, DOUBT, OTHER = "", "warning", "error"

# Old and new name of a float field, and the severity with which the number is reported.
_NAMES = {
    # spelling, form, order, qualifier
    "case": ("accelX", "accel_x", SAME),
    "written_together": ("load_cell", "loadcell", SAME),
    "plural": ("labels", "label", SAME),
    "short_form": ("temp", "temperature", SAME),
    "short_forms_of_two_words": ("cmd_pos", "command_position", SAME),
    "order": ("x_accel", "accel_x", SAME),
    "qualifier_added": ("speed", "motor_speed", SAME),
    "qualifier_dropped": ("battery_pack_voltage", "battery_voltage", SAME),
    "filler": ("imu_data", "imu_info", SAME),
    "unit_added": ("angle", "angle_deg", SAME),
    "number_with_zeros": ("motor_01", "motor_1", SAME),
    # cannot be decided
    "synonym": ("speed", "velocity", DOUBT),
    "misspelt": ("lattitude", "latitude", DOUBT),
    "letters_swapped": ("temperature", "tempreature", DOUBT),
    "form_of_a_word": ("calibrate", "calibrated", DOUBT),
    "perhaps_short": ("str", "string", DOUBT),
    "limit_added": ("speed", "speed_limit", DOUBT),
    "side_added": ("speed", "left_speed", DOUBT),
    "extreme_added": ("speed", "max_speed", DOUBT),
    "extreme_dropped": ("speed_min", "speed", DOUBT),
    "minutes": ("uptime_min", "uptime_s", DOUBT),
    "number_added": ("motor", "motor_2", DOUBT),
    "says_nothing": ("value", "speed", DOUBT),
    "one_of_many_words": ("range_test_plugin_enabled", "range_test_module_enabled", DOUBT),
    "unit": ("reach_mm", "reach_m", DOUBT),
    "scale": ("angle_x100", "angle_x10", DOUBT),
    "reference": ("position", "delta_position", DOUBT),
    # another meaning
    "other_words": ("voltage", "temperature", OTHER),
    "other_quantity": ("left_speed", "left_current", OTHER),
    "other_device": ("imu_status", "gps_status", OTHER),
    "other_quantity_of_many_words": ("range_test_plugin_speed", "range_test_plugin_current", OTHER),
    "other_device_of_a_few_words": ("imu_sensor_status", "gps_sensor_status", OTHER),
    "rhyme": ("light", "right", OTHER),
    "left_right": ("left_speed", "right_speed", OTHER),
    "front_rear": ("front_distance", "rear_distance", OTHER),
    "min_max": ("temp_min", "temp_max", OTHER),
    "minimum_maximum": ("minimum", "maximum", OTHER),
    "request_response": ("request_id", "response_id", OTHER),
    "start_stop": ("start_time", "stop_time", OTHER),
    "on_off": ("time_on", "time_off", OTHER),
    "read_write": ("read_count", "write_count", OTHER),
    "in_out": ("bytes_in", "bytes_out", OTHER),
    "up_down": ("up", "down", OTHER),
    "upper_lower": ("upper_bound", "lower_bound", OTHER),
    "open_close": ("open_angle", "closed_angle", OTHER),
    "enable_disable": ("enable", "disable", OTHER),
    "first_last": ("first_seen", "last_seen", OTHER),
    "axes": ("accel_x", "accel_y", OTHER),
    "lat_lon": ("lat", "lon", OTHER),
    "latitude_altitude": ("latitude", "altitude", OTHER),
    "tx_rx": ("tx_bytes", "rx_bytes", OTHER),
    "primary_secondary": ("primary_voltage", "secondary_voltage", OTHER),
    "source_destination": ("src_address", "destination_address", OTHER),
    "roll_pitch": ("roll", "pitch", OTHER),
    "pitch_yaw": ("pitch_rate", "yaw_rate", OTHER),
    "numbers": ("motor1", "motor2", OTHER),
    "letters": ("sensor_a", "sensor_b", OTHER),
    "opposite_and_qualifier": ("left_speed", "right_wheel_speed", OTHER),
    "turned_around": ("rover_to_board", "board_to_rover", OTHER),
    "places_changed": ("left_right", "right_left", OTHER),
    "negated": ("ready", "not_ready", OTHER),
}

# The old and the new content of a file, and the severity. The messages that are judged are named `A`.
_FILES = {
    "repeated_to_singular": ("message A { repeated float x = 1; }", "message A { float x = 1; }", OTHER),
    "singular_to_repeated": ("message A { int32 x = 1; }", "message A { repeated int32 x = 1; }", OTHER),
    "other_scalar": ("message A { int32 x = 1; }", "message A { float x = 1; }", OTHER),
    "wider_scalar": ("message A { int32 x = 1; }", "message A { int64 x = 1; }", SAME),
    "scalar_to_message": ("message A { int32 x = 1; }", "message A { B x = 1; } message B {}", OTHER),
    "map_of_other_values": (
        "message A { map<string, int32> x = 1; }",
        "message A { map<string, string> x = 1; }",
        OTHER,
    ),
    "map_of_wider_values": ("message A { map<int32, int32> x = 1; }", "message A { map<int32, int64> x = 1; }", SAME),
    "fields_swapped": (
        "message A { float speed = 1; float motor_speed = 2; }",
        "message A { float motor_speed = 1; float speed = 2; }",
        OTHER,
    ),
    "field_takes_the_number_of_another": (
        "message A { float speed = 1; float motor_speed = 2; }",
        "message A { float motor_speed = 1; reserved 2; }",
        OTHER,
    ),
    "unit_of_a_text": ("message A { string size_mm = 1; }", "message A { string size_m = 1; }", SAME),
    "type_renamed": (
        "message Wheel { float speed = 1; } message A { Wheel wheel = 1; }",
        "message Tyre { float speed = 1; } message A { Tyre wheel = 1; }",
        SAME,
    ),
    "type_renamed_with_its_field": (
        "message Gps { double latitude = 1; double longitude = 2; } message A { Gps gps = 1; }",
        "message Fix { double latitude = 1; double longitude = 2; } message A { Fix fix = 1; }",
        DOUBT,
    ),
    "payload_renamed": (
        "message Gps { double latitude = 1; double longitude = 2; } message A { oneof o { Gps gps = 1; } }",
        "message Fix { double latitude = 1; double longitude = 2; } message A { oneof o { Fix fix = 1; } }",
        SAME,
    ),
    "payload_renamed_after_its_type": (
        "message Gps { double latitude = 1; } message A { oneof o { Gps gps = 1; } }",
        "message Gps { double latitude = 1; } message A { oneof o { Gps place = 1; } }",
        SAME,
    ),
    "type_of_a_few_letters": (
        "message Gyro { float x = 1; float y = 2; float z = 3; } message A { oneof o { Gyro gyro = 1; } }",
        "message Accel { float x = 1; float y = 2; float z = 3; } message A { oneof o { Accel accel = 1; } }",
        OTHER,
    ),
    "empty_for_empty": (
        "message Ping {} message A { oneof o { Ping ping = 1; } }",
        "message Reset {} message A { oneof o { Reset reset = 1; } }",
        OTHER,
    ),
    "empty_for_empty_under_the_same_name": (
        "message Ping {} message A { oneof o { Ping command = 1; } }",
        "message Reset {} message A { oneof o { Reset command = 1; } }",
        DOUBT,
    ),
    "empty_renamed": (
        "message Ping {} message A { oneof o { Ping ping = 1; } }",
        "message PingRequest {} message A { oneof o { PingRequest ping = 1; } }",
        DOUBT,
    ),
    "one_type_for_all": (
        "message Empty {} message A { oneof o { Empty ping = 1; } }",
        "message Empty {} message A { oneof o { Empty reset = 1; } }",
        OTHER,
    ),
    "twin": (
        "message LeftArm { float elbow = 1; float grip = 2; } message A { oneof o { LeftArm arm = 1; } }",
        "message RightArm { float elbow = 1; float grip = 2; } message A { oneof o { RightArm arm = 1; } }",
        OTHER,
    ),
    "one_of_two_fields": (
        "message B { float elbow = 1; float grip = 2; } message A { B arm = 1; }",
        "message C { float elbow = 1; float motor_temperature = 2; } message A { C arm = 1; }",
        OTHER,
    ),
    "value_qualified": ("enum A { A_NONE = 0; A_DRIVE = 1; }", "enum A { A_NONE = 0; A_DRIVE_MANUAL = 1; }", SAME),
    "value_with_the_enum_s_prefix": (
        "enum Arm { ARM_NONE = 0; ARM_OPEN = 1; } message A { Arm arm = 1; }",
        "enum Arm { ARM_NONE = 0; ARM_CALIBRATING = 1; } message A { Arm arm = 1; }",
        OTHER,
    ),
    "value_without_a_name": ("enum A { A_UNKNOWN = 0; }", "enum A { A_UNSPECIFIED = 0; }", DOUBT),
    "values_swapped": (
        "enum A { A_NONE = 0; A_LEFT = 1; A_RIGHT = 2; }",
        "enum A { A_NONE = 0; A_RIGHT = 1; A_LEFT = 2; }",
        OTHER,
    ),
    "alias_renamed": (
        "enum A { option allow_alias = true; A_NONE = 0; A_OFF = 0; }",
        "enum A { option allow_alias = true; A_NONE = 0; A_IDLE = 0; }",
        SAME,
    ),
}
_EXTENSIBLE = "message A { extensions 100 to 199; } extend A { optional "
_EXTENSIONS = {
    "extension_renamed": (f"{_EXTENSIBLE} float speed = 100; }}", f"{_EXTENSIBLE} float motor_speed = 100; }}", SAME),
    "extension_replaced": (f"{_EXTENSIBLE} float speed = 100; }}", f"{_EXTENSIBLE} float current = 100; }}", OTHER),
    "extension_retyped": (f"{_EXTENSIBLE} float speed = 100; }}", f"{_EXTENSIBLE} string speed = 100; }}", OTHER),
    "extension_in_doubt": (f"{_EXTENSIBLE} float speed = 100; }}", f"{_EXTENSIBLE} float velocity = 100; }}", DOUBT),
    "extension_added": (
        _EXTENSIBLE + "float speed = 100; }",
        _EXTENSIBLE + "float speed = 100; optional int32 x = 101; }",
        SAME,
    ),
}
CASES = (
    _FILES
    | _EXTENSIONS
    | {
        name: (f"message A {{ float {old} = 1; }}", f"message A {{ float {new} = 1; }}", verdict)
        for name, (old, new, verdict) in _NAMES.items()
    }
)


_OF_MEANINGS = re.compile("WIR|HIS")


def _states(side: int) -> dict[str, str]:
    return {f"{name}.proto": _file(name, case[side]) for name, case in CASES.items()}


def _file(name: str, text: str) -> str:
    syntax = "proto2" if name in _EXTENSIONS else "proto3"
    return f'syntax = "{syntax}";\npackage {name};\n{text}\n'


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


def _checked_out(builder: RepositoryBuilder) -> str:
    root = builder.write()
    git(root, "reset", "--quiet", "--hard")
    return str(root)


@pytest.fixture(scope="module")
def repository(tmp_path_factory: pytest.TempPathFactory) -> str:
    """A repository that has the old state of all cases, and then the new one."""
    builder = RepositoryBuilder(tmp_path_factory.mktemp("protos") / "repository")
    builder.commit("Before", _states(0))
    builder.commit("After", _states(1))
    return _checked_out(builder)


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
    builder.commit("Without", {f"{name}.proto": _file(name, "message A { float other = 9; }") for name in _NAMES})
    builder.commit("After", _states(1))
    found = _verdicts(capsys, "--history", _checked_out(builder))
    assert {name: found[name] for name in _NAMES} == {name: verdict for name, (_, _, verdict) in _NAMES.items()}


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
    main(["lint", "--history", _checked_out(builder), "--format", "json"])
    assert [(one["id"], one["severity"]) for one in json.loads(capsys.readouterr().out)] == [("HIS105", "warning")]


# --- what holds for any names -----------------------------------------------------------------------------------------

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
