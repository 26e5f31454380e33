"""Messages as plain values: what `echo` prints and `pub` takes."""

from __future__ import annotations

from typing import Any

import pytest
from google.protobuf.any_pb2 import Any as AnyPayload
from google.protobuf.struct_pb2 import Struct, Value
from google.protobuf.timestamp_pb2 import Timestamp
from google.protobuf.type_pb2 import Option
from hypothesis import given, settings
from hypothesis import strategies as st
from strategies import messages

from generated.messages import ArmBoardDiagnostics, ImuSensorInformation
from generated.registry import REGISTRY
from roverlink import standard_types
from roverlink.runtime import ConversionError, SetupError
from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import nearest
from roverlink.runtime.core.messages import Message
from roverlink.runtime.text.values import message_from_values, message_to_values, payload_to_values

_STANDARD = ("sensor_msgs/msg/PointCloud2", "tf2_msgs/msg/TFMessage", "diagnostic_msgs/msg/DiagnosticArray")


@pytest.mark.parametrize("of", [ImuSensorInformation, ArmBoardDiagnostics, *_STANDARD])
@settings(max_examples=10)
@given(data=st.data())
def test_a_message_is_the_same_again_after_plain_values(of: type[Message] | str, data: st.DataObject) -> None:
    """The values of a message describe it completely: made from them, it has the same bytes."""
    message_type = standard_types.message_type(of) if isinstance(of, str) else of
    message = data.draw(messages(message_type))
    assert cdr.encode(message_from_values(message_type, message_to_values(message))) == cdr.encode(message)


def test_fields_that_are_left_out_are_zero() -> None:
    """A message from a part of its values has zeros, empty texts and empty lists in the rest, at every depth."""
    imu = standard_types.message_type("sensor_msgs/msg/Imu")
    message: Any = message_from_values(imu, {"header": {"stamp": {"sec": 7}}})
    assert message.header.stamp.sec == 7
    assert message.header.frame_id == ""
    assert message.orientation_covariance == [0.0] * 9
    assert message_from_values(imu, {}) == imu()


@pytest.mark.parametrize(("given", "expected"), [(1, 1.0), ("1e-3", 0.001), ("nan", None), ("-inf", -float("inf"))])
def test_numbers_for_floats_are_taken_as_they_are_written(given: object, expected: float | None) -> None:
    """An integer is a float as well, and so is 1e-3, which YAML takes for a text."""
    value = message_from_values(ImuSensorInformation, {"accel_x": given}).accel_x
    assert isinstance(value, float)
    assert value == expected or (expected is None and value != value)


@pytest.mark.parametrize(
    ("type_name", "values", "path", "expected"),
    [
        ("sensor_msgs/msg/Imu", 3, "", "3 is not a mapping of field names to values"),
        ("sensor_msgs/msg/Imu", {"hedder": {}}, "", "has no field 'hedder'; did you mean 'header'?"),
        ("sensor_msgs/msg/Imu", {"header": {"stamp": {"secs": 1}}}, "header.stamp", "did you mean 'sec'?"),
        ("sensor_msgs/msg/Imu", {1: 2}, "", "has no field 1"),
        ("std_msgs/msg/Empty", {"data": 1}, "", "has no field 'data'; it has no fields"),
        ("std_msgs/msg/Float32", {"data": "far"}, "data", "'far' is not a valid float32"),
        ("std_msgs/msg/Float32", {"data": True}, "data", "True is not a valid float32"),
        ("std_msgs/msg/Int8", {"data": True}, "data", "True is not a valid int8"),
        ("std_msgs/msg/Bool", {"data": 1}, "data", "1 is not a valid bool"),
        ("std_msgs/msg/String", {"data": 1}, "data", "1 is not a string"),
        ("std_msgs/msg/UInt8MultiArray", {"data": [1, 256]}, "data", "does not fit uint8"),
        ("std_msgs/msg/UInt8MultiArray", {"data": "abc"}, "data", "'abc' is not a list"),
        ("std_msgs/msg/Float64MultiArray", {"data": [1, "x"]}, "data[1]", "'x' is not a valid float64"),
        ("tf2_msgs/msg/TFMessage", {"transforms": [{}, {"child": 1}]}, "transforms[1]", "has no field 'child'"),
    ],
)
def test_values_of_another_kind_are_refused_with_their_path(
    type_name: str, values: object, path: str, expected: str
) -> None:
    """A wrong name or value is a `ConversionError` with the path to it, and the nearest name that there is."""
    with pytest.raises(ConversionError) as caught:
        message_from_values(standard_types.message_type(type_name), values)
    assert caught.value.field == path
    assert expected in str(caught.value)


def test_a_payload_as_plain_values() -> None:
    """A payload has its proto names, zeros included, and enum values by name."""
    values = payload_to_values(REGISTRY.by_name["ph_info"].payload_type(voltage=1.5, state=3))
    assert values == {
        "ph_value": 0.0,
        "voltage": 1.5,
        "temperature": 0.0,
        "state": "SENSOR_ERROR",
        "error_code": "PH_NO_ERROR",
    }


def test_the_nearest_name_is_found() -> None:
    """A name that is nearly right leads to the right one; else there is a list, and no endless one."""
    assert nearest("imu_dat", ["gps_data", "imu_data"]) == "did you mean 'imu_data'?"
    assert nearest("zzz", ["a", "b"]) == "known: a, b"
    assert nearest("zzz", [f"n{number}" for number in range(100)]).endswith("n29 and 70 more")


# --- standard types ---------------------------------------------------------------------------------------------


def test_what_is_no_type_is_told() -> None:
    """A name of another form is quoted, with an example; an unknown type leads to the one that was probably meant."""
    for name in ("Imu", "", "a/b/c/d", "sensor_msgs//Imu", "/Imu", "sensor_msgs/"):
        with pytest.raises(SetupError, match="is not the name of a ROS 2 type, such as sensor_msgs/msg/Imu"):
            standard_types.full_name(name)
    with pytest.raises(SetupError, match=r"unknown ROS 2 type 'sensor_msgs/msg/Imus'; did you mean '.*/Imu'\?"):
        standard_types.message_type("sensor_msgs/msg/Imus")


def test_what_json_has_no_form_for_is_shown_field_by_field() -> None:
    """A peer chooses what an Any or a time holds; whatever it is, it is shown."""
    assert payload_to_values(AnyPayload(type_url="example.com/Unknown", value=b"abc")) == {
        "type_url": "example.com/Unknown",
        "value": "YWJj",
    }
    assert payload_to_values(Timestamp(seconds=10**15)) == {"seconds": 10**15}
    option = Option(name="one", value=AnyPayload(type_url="example.com/Unknown"))
    assert payload_to_values(option) == {"name": "one", "value": {"type_url": "example.com/Unknown"}}
    struct = Struct(fields={"a": Value(number_value=float("inf")), "b": Value()})
    assert payload_to_values(struct) == {"fields": {"a": {"number_value": float("inf")}, "b": None}}
