"""`roverlink echo` and `roverlink pub`: topics with no ROS installed."""

from __future__ import annotations

import json
import math
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from needs import needs_dds
from polling import wait_until
from programs import Start
from repeating import repeated
from running import Called

from generated.messages import DrivingBoardMotorMessage, ImuSensorInformation
from generated.registry import REGISTRY
from roverlink import topic_types
from roverlink.__main__ import main
from roverlink.runtime import Qos
from roverlink.runtime.core import cdr
from roverlink.runtime.interfaces.std_msgs import String
from roverlink.runtime.middleware import NodeIdentity, open_middleware

_ROOT = Path(__file__).parents[2]


@pytest.mark.slow
@needs_dds
def test_yaml_as_ros2_topic_echo_prints_it(start: Start) -> None:
    """A message is a YAML document, closed by three dashes; zeros are printed; Ctrl-C ends both commands well."""
    listener = start("echo", "drive_motor")
    talker = start("pub", "drive_motor", "{distance_to_go: 1.5}", "--rate", 20)
    wait_until(lambda: listener.output.count("---") >= 2, "two messages")
    assert talker.interrupt() == 0
    assert listener.interrupt() == 0
    assert listener.output[:6] == ["distance_to_go: 1.5", "turning_radius: 0.0", "---"] * 2


@pytest.mark.slow
@needs_dds
def test_topics_of_standard_types(start: Start, called: Called) -> None:
    """A topic that no row has is read and written by the name of its type."""
    values = "{header: {frame_id: 'on', stamp: {sec: 7}}}"
    talker = start("pub", "/imu/raw", values, "--type", "sensor_msgs/Imu", "--rate", 20, "--wait", 60)
    code, output, _ = called("echo", "/imu/raw", "--type", "sensor_msgs/msg/Imu", "--count", 1)
    assert code == 0
    assert talker.interrupt() == 0
    printed = output.splitlines()
    document = yaml.safe_load("\n".join(printed[:-1]))
    assert document["header"] == {"stamp": {"sec": 7, "nanosec": 0}, "frame_id": "on"}
    assert document["orientation_covariance"] == [0.0] * 9
    assert printed[:4] == ["header:", "  stamp:", "    sec: 7", "    nanosec: 0"]


@needs_dds
@pytest.mark.parametrize(
    ("reliability", "durability"), [("reliable", "transient_local"), ("best_effort", "transient_local")]
)
def test_echo_adapts_to_the_publisher(called: Called, reliability: str, durability: str) -> None:
    """Any publisher is heard; what a latched and reliable one has published before echo started is printed too."""
    message = cdr.encode(DrivingBoardMotorMessage(distance_to_go=2.5))
    with open_middleware("dds", NodeIdentity("driver")) as driver:
        publisher = driver.publisher("/drive_motor", DrivingBoardMotorMessage, Qos(reliability, durability))
        publisher.publish([message])
        again = repeated(lambda _: publisher.publish([message])) if reliability == "best_effort" else nullcontext()
        with again:
            code, output, _ = called("echo", "drive_motor", "--json", "--count", 1, "--timeout", 60)
    assert code == 0
    assert json.loads(output)["distance_to_go"] == 2.5


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        (f"echo imu_data --project {_ROOT} --middleware memory", "0 messages came on imu_data"),
        ("echo /chatter --type std_msgs/msg/String --middleware memory", "0 messages came on /chatter"),
        (f"listen --port 0 --project {_ROOT}", "0 datagrams came"),
    ],
)
def test_silence_for_too_long_is_exit_code_1(line: str, expected: str, tmp_path: Path, called: Called) -> None:
    """With `--timeout`, too few messages in time are told, and exit code 1; `echo --type` needs no project."""
    code, output, errors = called(*line.split(), "--timeout", "0.1", folder=tmp_path)
    assert (code, output, errors.endswith(f"stopped after 0.1 s: only {expected}")) == (1, "", True)


def test_publishing_to_nobody_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    """Where nobody listens, it publishes all the same, and says so."""
    assert main(["pub", "drive_motor", "--once", "--wait", "0", "--middleware", "memory"]) == 0
    output, errors = capsys.readouterr()
    assert output == "published 1 on drive_motor\n"
    assert errors == "no subscriber on drive_motor yet; publishing anyway\n"


@needs_dds
@pytest.mark.parametrize(
    "words", ["imu_data --ros-args -r __ns:=/rover1", "/rover1/imu_data", "x --ros-args -r x:=/rover1/imu_data"]
)
def test_a_topic_in_a_namespace_needs_no_type(words: str, called: Called) -> None:
    """The bridge's own arguments find the row's topic; where no row has it, its publisher tells the type."""
    message = cdr.encode(ImuSensorInformation(accel_x=1.5))
    with open_middleware("dds", NodeIdentity("bridge")) as bridge:
        publisher = bridge.publisher("/rover1/imu_data", ImuSensorInformation, Qos("reliable", "transient_local"))
        publisher.publish([message])
        topic, *ros = words.split()
        code, output, errors = called("echo", topic, "--json", "--count", 1, "--timeout", 60, *ros)
    assert (code, json.loads(output or "{}").get("accel_x")) == (0, 1.5), errors


@pytest.mark.parametrize("topic", ["imu_data", "/imu_data"])
def test_a_rows_topic_has_the_rows_type_and_quality(topic: str) -> None:
    """With or without the leading slash, what the table says of the topic is what is published and subscribed."""
    handler = REGISTRY.by_name["imu_info"]
    assert topic_types.endpoint(REGISTRY, topic, None) == (ImuSensorInformation, handler.route.qos)


def test_a_topic_that_a_program_declares_needs_no_type() -> None:
    """Its node says which messages it has."""
    assert topic_types.endpoint(REGISTRY, "/drive/state", None) == (String, Qos())


def test_a_given_type_goes_before_the_rows() -> None:
    """A topic under another name may have a row's type; what is said on the line counts, whatever the table has."""
    for name in ("comms/msg/DrivingBoardMotorMessage", "comms/DrivingBoardMotorMessage"):
        assert topic_types.endpoint(REGISTRY, "x", name) == (DrivingBoardMotorMessage, Qos())
    message_type, _ = topic_types.endpoint(REGISTRY, "imu_data", "std_msgs/String")
    assert message_type.__msgtype__ == "std_msgs/msg/String"


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


@pytest.mark.slow
@settings(suppress_health_check=[HealthCheck.too_slow], max_examples=50)
@given(_MESSAGES)
def test_printed_messages_are_read_as_the_same_values(values: dict[str, Any]) -> None:
    """YAML reads any values back, in order; JSON is one line that any reader takes, without NaN, which JSON has not."""
    text = topic_types.yaml_text(values)
    assert _same(yaml.safe_load(text), values), text
    assert text.endswith("\n")
    line = topic_types.json_text(values)
    assert len(line.splitlines()) == 1
    assert list(json.loads(line, parse_constant=pytest.fail)) == list(values)


def test_json_has_names_for_numbers_that_it_cannot_spell() -> None:
    """Infinities and NaN are texts."""
    told = json.loads(topic_types.json_text({"a": [math.inf, -math.inf, math.nan]}))
    assert told == {"a": ["Infinity", "-Infinity", "NaN"]}


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
