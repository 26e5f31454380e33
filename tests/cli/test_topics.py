"""`roverlink echo` and `roverlink pub`: topics with no ROS installed."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable
from typing import Any

import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from needs import needs_dds
from polling import wait_until

from generated.messages import DrivingBoardMotorMessage, ImuSensorInformation
from generated.registry import REGISTRY
from roverlink import topic_types
from roverlink.__main__ import main
from roverlink.runtime import Qos, SetupError
from roverlink.runtime.core import cdr
from roverlink.runtime.middleware import NodeIdentity, open_middleware
from roverlink.runtime.text.values import message_to_values

Start = Callable[..., Any]


# --- across DDS -------------------------------------------------------------------------------------------------


def _crossed(start: Start, echo: tuple[object, ...], pub: tuple[object, ...]) -> list[str]:
    """What an echo prints of what a pub publishes until the echo has enough."""
    listener = start("echo", *echo)
    talker = start("pub", *pub, "--rate", 20, "--wait", 60)
    assert listener.end() == 0
    assert talker.interrupt() == 0
    printed: list[str] = listener.output
    return printed


@needs_dds
def test_yaml_as_ros2_topic_echo_prints_it(start: Start) -> None:
    """A message is a YAML document, closed by three dashes; fields that were not given are zero."""
    printed = _crossed(
        start,
        ("drive_motor", "--count", 2),
        ("drive_motor", "{distance_to_go: 1.5}"),
    )
    assert printed == ["distance_to_go: 1.5", "turning_radius: 0.0", "---"] * 2


@needs_dds
@pytest.mark.slow
def test_json_by_ros_field_names(start: Start) -> None:
    """With `--json`, a message is one object on one line, nested messages within it."""
    values = "{accel_x: 0.25, accel_y: 1e-3, accel_z: .nan, is_calibrated: true, state: {state: 3}, error_code: 8}"
    printed = _crossed(start, ("imu_data", "--count", 1, "--json"), ("/imu_data", values))
    said = json.loads(printed[0])
    assert list(said) == list(message_to_values(ImuSensorInformation()))
    assert said["accel_x"] == 0.25
    assert said["accel_y"] == pytest.approx(0.001)
    assert said["accel_z"] == "NaN"
    assert said["is_calibrated"] is True
    assert (said["state"], said["error_code"]) == ({"state": 3}, 8)


@needs_dds
def test_topics_of_standard_types(start: Start) -> None:
    """A topic that no row has is read and written by the name of its type."""
    printed = _crossed(
        start,
        ("/imu/raw", "--type", "sensor_msgs/msg/Imu", "--count", 1),
        ("/imu/raw", "{header: {frame_id: 'on', stamp: {sec: 7}}}", "--type", "sensor_msgs/Imu"),
    )
    document = yaml.safe_load("\n".join(printed[:-1]))
    assert document["header"] == {"stamp": {"sec": 7, "nanosec": 0}, "frame_id": "on"}
    assert document["orientation_covariance"] == [0.0] * 9
    assert printed[:4] == ["header:", "  stamp:", "    sec: 7", "    nanosec: 0"]


@needs_dds
@pytest.mark.slow
def test_a_best_effort_publisher_is_heard_where_it_is_asked_for(start: Start) -> None:
    """`--best-effort` subscribes as sensor drivers publish; it hears reliable publishers as well."""
    printed = _crossed(start, ("drive_motor", "--best-effort", "--count", 1, "--json"), ("drive_motor",))
    assert json.loads(printed[0]) == {"distance_to_go": 0.0, "turning_radius": 0.0}


@needs_dds
@pytest.mark.parametrize("reliability", ["best_effort", "reliable"])
@pytest.mark.parametrize("durability", ["transient_local", pytest.param("volatile", marks=pytest.mark.slow)])
def test_echo_adapts_to_the_publisher(
    start: Start, environment: dict[str, str], monkeypatch: pytest.MonkeyPatch, reliability: str, durability: str
) -> None:
    """Any publisher is heard; what a latched and reliable one has published before echo started is printed too."""
    for name in ("ROS_LOCALHOST_ONLY", "ROS_DOMAIN_ID"):
        monkeypatch.setenv(name, environment[name])
    message = cdr.encode(DrivingBoardMotorMessage(distance_to_go=2.5))
    with open_middleware("dds", NodeIdentity("driver")) as driver:
        publisher = driver.publisher("/drive_motor", DrivingBoardMotorMessage, Qos(reliability, durability))
        publisher.publish([message])
        listener = start("echo", "drive_motor", "--json", "--count", 1)
        if (reliability, durability) != ("reliable", "transient_local"):
            wait_until(publisher.has_subscribers, "echo")
            publisher.publish([message])
        assert listener.end() == 0
    assert json.loads(listener.output[0])["distance_to_go"] == 2.5


@needs_dds
@pytest.mark.slow
def test_once_is_once(start: Start) -> None:
    """`--once` publishes one message, to the subscriber for which it waited."""
    listener = start("echo", "drive_motor", "--json", "--count", 2, "--timeout", 5)
    talker = start("pub", "drive_motor", "--once", "{distance_to_go: 3}", "--wait", 60)
    assert talker.end() == 0
    assert talker.output == ["published 1 on drive_motor"]
    listener.wait_for("distance_to_go", listener.output)
    assert listener.interrupt() == 0
    assert [json.loads(line)["distance_to_go"] for line in listener.output] == [3.0]


@needs_dds
def test_silence_for_too_long_is_exit_code_1(done: Start) -> None:
    """With `--timeout`, too few messages in time are told, and exit code 1."""
    code, output, errors = done("echo", "imu_data", "--timeout", 0.3)
    assert (code, output) == (1, "")
    assert errors == "stopped after 0.3 s: only 0 messages came on imu_data"


@needs_dds
def test_publishing_to_nobody_is_told(done: Start) -> None:
    """Where nobody listens, it publishes all the same, and says so."""
    code, output, errors = done("pub", "drive_motor", "--once", "--wait", 0)
    assert (code, output) == (0, "published 1 on drive_motor")
    assert errors == "no subscriber on drive_motor yet; publishing anyway"


@needs_dds
@pytest.mark.parametrize("command", ["echo", "pub"])
def test_an_interrupt_ends_it_well(start: Start, command: str) -> None:
    """Ctrl-C is how they are meant to end."""
    program = start(command, "drive_motor", *(["--wait", 0] if command == "pub" else []))
    if command == "pub":
        program.wait_for("published 1", program.output)
    else:
        talker = start("pub", "drive_motor", "--rate", 50)
        program.wait_for("---", program.output)
        assert talker.interrupt() == 0
    assert program.interrupt() == 0


# --- bad input --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (
            ["echo", "imu_dat"],
            "no row of mapping.yaml has the topic 'imu_dat' (did you mean 'imu_data'?); for a topic without a row",
        ),
        (["echo", "x", "--type", "Imu"], "'Imu' is not the name of a ROS 2 type, such as sensor_msgs/msg/Imu"),
        (
            ["echo", "x", "--type", "sensor_msgs/msg/Imus"],
            "unknown ROS 2 type 'sensor_msgs/msg/Imus'; did",
        ),
        (["echo", "x", "--type", "a/msg/B"], "unknown ROS 2 type 'a/msg/B'"),
        (["echo", "imu data", "--type", "std_msgs/String"], "'imu data' is not a topic name"),
        (["pub", "drive_moto"], "did you mean 'drive_motor'?"),
        (["pub", "drive_motor", "{distance: 1}"], "has no field 'distance'; did you mean 'distance_to_go'?"),
        (["pub", "drive_motor", "{distance_to_go: far}"], "distance_to_go: 'far' is not a valid float32"),
        (["pub", "drive_motor", "{distance_to_go: 1e39}"], "distance_to_go: 1e+39 does not fit float32"),
        (
            ["pub", "drive_motor", "{distance_to_go: 2024-13-45}"],
            "cannot read the message: 2024-13-45 is not a valid value",
        ),
        (["pub", "drive_motor", "{distance_to_go: !!timestamp x}"], "cannot read the message: x is not a valid value"),
        (["pub", "drive_motor", "{distance_to_go: 1, distance_to_go: 2}"], "the key distance_to_go occurs twice"),
        (["pub", "drive_motor", "{distance_to_go: 1"], "cannot read the message: not valid YAML"),
        (["pub", "drive_motor", "[" * 3000], "cannot read the message: nested too deeply"),
        (["pub", "drive_motor", "1.5"], "1.5 is not a mapping of field names to values"),
        (["pub", "imu_data", "{error_code: 300}"], "error_code: 300 does not fit uint8"),
        (["pub", "x", "{data: 3}", "--type", "std_msgs/String"], "data: 3 is not a string"),
        (["pub", "2x", "--type", "std_msgs/String"], "'2x' is not a topic name"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_what_cannot_be_is_told(arguments: list[str], expected: str, capsys: pytest.CaptureFixture[str]) -> None:
    """Exit code 2 and one line that quotes what is wrong, before anything is opened."""
    assert main([*arguments, "--middleware", "memory"]) == 2
    output, errors = capsys.readouterr()
    assert output == ""
    assert errors.startswith("roverlink: ")
    assert expected in errors


# --- which type a topic has -------------------------------------------------------------------------------------


@pytest.mark.parametrize("topic", ["imu_data", "/imu_data"])
def test_a_rows_topic_has_the_rows_type_and_quality(topic: str) -> None:
    """With or without the leading slash, what the table says of the topic is what is published and subscribed."""
    handler = REGISTRY.by_name["imu_info"]
    assert topic_types.endpoint(REGISTRY, topic, None) == (ImuSensorInformation, handler.route.qos)


def test_a_type_of_the_table_is_known_by_its_name() -> None:
    """A topic under another name may have a row's type."""
    for name in ("comms/msg/DrivingBoardMotorMessage", "comms/DrivingBoardMotorMessage"):
        assert topic_types.endpoint(REGISTRY, "x", name) == (DrivingBoardMotorMessage, Qos())


def test_a_given_type_goes_before_the_rows() -> None:
    """What is said on the line counts, whatever the table has."""
    message_type, _ = topic_types.endpoint(REGISTRY, "imu_data", "std_msgs/String")
    assert message_type.__msgtype__ == "std_msgs/msg/String"


def test_a_topic_without_a_row_needs_a_type() -> None:
    """The error says which topics there are."""
    with pytest.raises(
        SetupError, match=r"no row of mapping.yaml has the topic '/zzz' \(known: ph_data, .*with --type"
    ):
        topic_types.endpoint(REGISTRY, "/zzz", None)


@pytest.mark.parametrize("topic", ["imu data", "", "/", "2x", "a//b", "a/", "~", "~a", "a-b", "rt/ä"])
def test_what_is_no_topic_name_is_told(topic: str) -> None:
    """A name that ROS 2 would not take is quoted, whether or not a type is given."""
    for type_name in (None, "std_msgs/String"):
        with pytest.raises(SetupError, match=f"'{re.escape(topic)}' is not a topic name"):
            topic_types.endpoint(REGISTRY, topic, type_name)


# --- how a message is printed -----------------------------------------------------------------------------------

_NAMES = st.from_regex(r"[a-z][a-z0-9_]{0,8}", fullmatch=True)
_TROUBLE = (
    *["true", "no", "null", "~", "", " x", "x ", "1", "1.5", "1e5", "1e-3", ".inf", "0x1", "-", "---", "...", "a: b"],
    *["#", "'", '"', "\\", "a\nb", "\n", "a\n", "\t", "[1]", "{a}", "- a", "? a", "!x", "&x", "*x", "%x", "@", "`"],
    *["2024-01-01", "12:30", "=", "<<", "\u2028", "\x85", "\ufeff", "\x7f", "\U0001f680"],
)
_TEXTS = st.one_of(st.text(max_size=12), st.sampled_from(_TROUBLE))
_NUMBERS = st.one_of(st.integers(-(2**63), 2**64), st.floats(), st.sampled_from([1e-7, 1e20, -0.0, 1.5e-300]))
_VALUES = st.recursive(
    st.one_of(st.booleans(), _NUMBERS, _TEXTS),
    lambda values: st.one_of(st.lists(values, max_size=4), st.dictionaries(_NAMES, values, max_size=4)),
    max_leaves=12,
)
_MESSAGES = st.dictionaries(_NAMES, _VALUES, max_size=5)


def _same(left: Any, right: Any) -> bool:
    """Equal in value and type, with NaN equal to itself."""
    if isinstance(left, dict):
        return isinstance(right, dict) and list(left) == list(right) and all(_same(left[k], right[k]) for k in left)
    if isinstance(left, list):
        return isinstance(right, list) and len(left) == len(right) and all(map(_same, left, right))
    if type(left) is not type(right):
        return False
    return bool(left == right) or (isinstance(left, float) and math.isnan(left) and math.isnan(right))


@settings(suppress_health_check=[HealthCheck.too_slow], max_examples=40)
@given(_MESSAGES)
def test_printed_yaml_is_read_as_the_same_values(values: dict[str, Any]) -> None:
    """Whatever a message holds, YAML reads it back equal in value and type, with its fields in order."""
    text = topic_types.yaml_text(values)
    assert _same(yaml.safe_load(text), values), text
    assert text.endswith("\n")


@settings(suppress_health_check=[HealthCheck.too_slow], max_examples=50)
@given(_MESSAGES)
def test_printed_json_is_one_strict_line(values: dict[str, Any]) -> None:
    """Whatever a message holds, it is one line of JSON that any reader takes: without NaN, which JSON has not."""

    def refuse(constant: str) -> None:
        raise AssertionError(constant)

    text = topic_types.json_text(values)
    assert len(text.splitlines()) == 1
    read = json.loads(text, parse_constant=refuse)
    assert list(read) == list(values)


def test_numbers_that_json_lacks_are_named_as_protobuf_names_them() -> None:
    """Not a number and the infinities are strings, as in what `listen` prints."""
    values = {"a": math.nan, "b": [math.inf, -math.inf, 1.5], "c": {"d": math.nan}}
    assert json.loads(topic_types.json_text(values)) == {
        "a": "NaN",
        "b": ["Infinity", "-Infinity", 1.5],
        "c": {"d": "NaN"},
    }


def test_the_form_of_printed_yaml_is_ros2s() -> None:
    """Nested messages are indented, lists are blocks that are not, nothing is folded, empty lists stay on one line."""
    values = {
        "header": {"stamp": {"sec": 1}, "frame_id": ""},
        "transforms": [{"x": 1.0, "name": "a"}, {"x": 1e-7, "name": "true"}],
        "covariance": [0.0, 1.0],
        "empty": [],
        "text": "word " * 40,
    }
    assert topic_types.yaml_text(values).splitlines() == [
        "header:",
        "  stamp:",
        "    sec: 1",
        "  frame_id: ''",
        "transforms:",
        "- x: 1.0",
        "  name: a",
        "- x: 1.0e-07",
        "  name: 'true'",
        "covariance:",
        "- 0.0",
        "- 1.0",
        "empty: []",
        "text: '" + "word " * 40 + "'",
    ]
    assert topic_types.yaml_text({}) == "{}\n"
