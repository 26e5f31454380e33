"""Types of google.protobuf that mean more than their fields: hand-computed values, and what must be refused."""

from __future__ import annotations

from pathlib import Path

import pytest
from google.protobuf.duration_pb2 import Duration as DurationPayload
from google.protobuf.json_format import ParseDict
from google.protobuf.struct_pb2 import ListValue, Struct, Value
from google.protobuf.timestamp_pb2 import Timestamp
from hypothesis import example, given
from hypothesis import strategies as st

from roverlink.runtime.convert.well_known import duration, json_list, json_struct, json_value, timestamp
from roverlink.runtime.core.errors import ConversionError
from roverlink.runtime.interfaces import Duration, Time

_INT32 = st.integers(-(2**31), 2**31 - 1)
_JSON_TEXTS = [
    line.split("\t")
    for line in (Path(__file__).parents[2] / "cpp/tests/json_texts.tsv").read_text(encoding="utf-8").split("\n")
    if line and not line.startswith("#")
]
_NANOSECONDS = st.integers(0, 999_999_999)

# --- times ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("seconds", "nanos"), [(2**31, 0), (-(2**31) - 1, 0), (253_402_300_799, 0), (0, -1), (0, 1_000_000_000)]
)
def test_a_timestamp_that_is_no_time_is_refused(seconds: int, nanos: int) -> None:
    """Nothing before 1901 or after 2038 fits; nanoseconds are from 0 to a second."""
    with pytest.raises(ConversionError, match=r"^stamp: "):
        timestamp.to_ros(Timestamp(seconds=seconds, nanos=nanos), "stamp")


@pytest.mark.parametrize(
    ("seconds", "nanos"),
    [(1, -1), (-1, 1), (0, 1_000_000_000), (0, -1_000_000_000), (2**31, 0), (-(2**31), -1), (315_576_000_000, 0)],
)
def test_a_duration_that_is_none_is_refused(seconds: int, nanos: int) -> None:
    """Parts of two signs, a second or more of nanoseconds, and what is longer than 68 years."""
    with pytest.raises(ConversionError, match=r"^took: "):
        duration.to_ros(DurationPayload(seconds=seconds, nanos=nanos), "took")


@pytest.mark.parametrize("nanosec", [1_000_000_000, 2**32 - 1])
def test_a_second_of_nanoseconds_is_refused_from_ros(nanosec: int) -> None:
    """ROS 2's uint32 holds more nanoseconds than a second has."""
    with pytest.raises(ConversionError, match=r"^stamp: "):
        timestamp.from_ros(Time(0, nanosec), "stamp")
    with pytest.raises(ConversionError, match=r"^stamp: "):
        duration.from_ros(Duration(-1, nanosec), "stamp")


@given(_INT32, _NANOSECONDS)
@example(-1, 500_000_000)
def test_every_time_of_ros_comes_back(sec: int, nanosec: int) -> None:
    """A timestamp counts nanoseconds upwards in both, before 1970 too; a duration's parts have one sign in protobuf."""
    assert timestamp.from_ros(Time(sec, nanosec), "") == Timestamp(seconds=sec, nanos=nanosec)
    assert timestamp.to_ros(Timestamp(seconds=sec, nanos=nanosec), "") == Time(sec, nanosec)
    payload = duration.from_ros(Duration(sec, nanosec), "")
    assert payload.seconds * 10**9 + payload.nanos == sec * 10**9 + nanosec
    assert payload.seconds * payload.nanos >= 0
    assert duration.to_ros(payload, "") == Duration(sec, nanosec)


# --- JSON -------------------------------------------------------------------------------------------------------


def test_json_says_what_a_struct_says() -> None:
    """Keys in order, doubles with all their digits, text as it is."""
    payload = ParseDict({"b": [1, None, True, {}], "a": 0.1, "ä": "\0"}, Struct())
    text = json_struct.to_ros(payload, "config")
    assert text == '{"a": 0.1, "b": [1.0, null, true, {}], "ä": "\\u0000"}'
    assert json_struct.from_ros(text, "config") == payload


@pytest.mark.parametrize(("text", "same"), [("null", "null"), ("-0", "0.0"), ("[1, -2, 3e2]", "[1.0, -2.0, 300.0]")])
def test_whole_numbers_in_json_are_doubles(text: str, same: str) -> None:
    """What a person writes without a point is the same number, without a negative zero; null is a value."""
    assert json_value.to_ros(json_value.from_ros(text, ""), "") == same
    assert (json_list.to_ros(ListValue(), ""), json_struct.to_ros(Struct(), "")) == ("[]", "{}")


@pytest.mark.parametrize(("kind", "text", "written"), _JSON_TEXTS, ids=[text[:20] for _, text, _ in _JSON_TEXTS])
def test_json_means_what_it_means_in_cpp(kind: str, text: str, written: str) -> None:
    """The C++ runtime library is tested with the same table."""
    if kind == "same":
        assert json_value.to_ros(json_value.from_ros(text, "note"), "note") == written
    else:
        with pytest.raises(ConversionError, match=r"^note: "):
            json_value.from_ros(text, "note")


def test_another_kind_of_json_is_refused() -> None:
    """A Struct is an object, a ListValue a list."""
    with pytest.raises(ConversionError, match="not an object"):
        json_struct.from_ros("[]", "config")
    with pytest.raises(ConversionError, match="not an array"):
        json_list.from_ros("{}", "list")


@pytest.mark.parametrize("payload", [Value(), Value(number_value=float("nan")), Value(number_value=float("-inf"))])
def test_a_value_that_no_json_can_say_is_refused(payload: Value) -> None:
    """One without a kind, and numbers that are none."""
    with pytest.raises(ConversionError, match=r"^note: "):
        json_value.to_ros(payload, "note")
    with pytest.raises(ConversionError, match=r"^note: "):
        json_list.to_ros(ListValue(values=[payload]), "note")
