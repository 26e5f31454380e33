"""The extra_topics of this repository's table: standard messages with the right physical values, and back."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rosbags.typesys import Stores, get_typestore
from rosbags.typesys.store import Typestore

from generated.registry import REGISTRY
from roverlink.runtime import ConversionError
from roverlink.runtime.core import cdr
from roverlink.runtime.core.standard_handler import StandardHandler
from roverlink.runtime.interfaces import Time

_EXTRA_TOPICS = {handler.route.topic: handler for handler in REGISTRY.extra_topics}
_STORES = [get_typestore(Stores.ROS2_HUMBLE), get_typestore(Stores.ROS2_JAZZY)]
_NUMBERS = st.floats(width=32, allow_nan=False, allow_infinity=False)
_STAMPS = st.builds(Time, st.integers(-(2**31), 2**31 - 1), st.integers(0, 2**32 - 1))


def _close(found: float, wanted: float) -> None:
    assert found == pytest.approx(wanted, rel=1e-15, abs=0)


def _imu(message: Any, payload: dict[str, Any]) -> None:
    """Degrees a second become radians a second, by the definition of a degree; the orientation is said to be none."""
    for axis in "xyz":
        _close(getattr(message.angular_velocity, axis), payload[f"gyro_{axis}"] * 3.141592653589793 / 180)
        assert getattr(message.linear_acceleration, axis) == payload[f"accel_{axis}"]
    assert message.orientation_covariance.tolist() == [-1, 0, 0, 0, 0, 0, 0, 0, 0]
    assert message.angular_velocity_covariance.tolist() == message.linear_acceleration_covariance.tolist() == [0] * 9
    assert (message.orientation.x, message.orientation.y, message.orientation.z, message.orientation.w) == (0, 0, 0, 1)


def _mag(message: Any, payload: dict[str, Any]) -> None:
    """A microtesla is a millionth of a tesla."""
    for axis in "xyz":
        _close(getattr(message.magnetic_field, axis), payload[f"mag_{axis}"] * 1e-6)


def _fix(message: Any, payload: dict[str, Any]) -> None:
    """The position stays as it is; the quality is what NavSatStatus calls it, as the usual GPS nodes have it."""
    assert (message.latitude, message.longitude) == (payload["latitude"], payload["longitude"])
    assert message.altitude == payload["altitude"]
    assert message.status.status == [-1, 0, 1, 0, 2, 2][payload["fix_quality"]]
    assert (message.status.service, message.position_covariance_type) == (1, 1)
    assert list(message.position_covariance) == [6.25, 0, 0, 0, 6.25, 0, 0, 0, 25]


def _pressure(message: Any, payload: dict[str, Any]) -> None:
    """A kilopascal is 1000 pascal."""
    _close(message.fluid_pressure, payload["pressure_kpa"] * 1000)
    assert message.variance == 0


def _position(message: Any, payload: dict[str, Any]) -> None:
    """The position is in metres on both sides."""
    position = message.pose.pose.position
    assert (position.x, position.y, position.z) == (payload["x"], payload["y"], payload["z"])


def _celsius(field: str) -> Callable[[Any, dict[str, Any]], None]:
    def check(message: Any, payload: dict[str, Any]) -> None:
        """Temperature is in degrees Celsius on both sides."""
        assert message.temperature == payload[field]

    return check


_CHECKS: dict[str, tuple[str, Callable[[Any, dict[str, Any]], None]]] = {
    "imu/data_raw": ("imu_link", _imu),
    "imu/mag": ("imu_link", _mag),
    "gps/fix": ("gps_link", _fix),
    "pressure/fluid_pressure": ("pressure_link", _pressure),
    "pressure/temperature": ("pressure_link", _celsius("temperature_c")),
    "ph/temperature": ("ph_link", _celsius("temperature")),
    "odometry/global": ("map", _position),
}


def _payloads(handler: StandardHandler[Any, Any]) -> st.SearchStrategy[dict[str, Any]]:
    """Every number of a payload, and any declared value of its enums."""
    fields: dict[str, st.SearchStrategy[Any]] = {}
    for field in handler.payload_type.DESCRIPTOR.fields:
        if field.enum_type is not None:
            fields[field.name] = st.sampled_from([value.number for value in field.enum_type.values])
        elif field.cpp_type in (field.CPPTYPE_FLOAT, field.CPPTYPE_DOUBLE):
            fields[field.name] = _NUMBERS
    return st.fixed_dictionaries(fields)


@pytest.mark.parametrize("topic", sorted(_EXTRA_TOPICS))
@given(data=st.data())
@settings(max_examples=10)
def test_a_feed_says_what_the_payload_says(topic: str, data: st.DataObject) -> None:
    """Any payload, as protobuf, becomes CDR in which Humble and Jazzy read the physical values, and comes back."""
    handler, (frame_id, check) = _EXTRA_TOPICS[topic], _CHECKS[topic]
    fields, stamp = data.draw(_payloads(handler)), data.draw(_STAMPS)
    payload = handler.payload_type.FromString(handler.payload_type(**fields).SerializeToString())
    serialized = handler.to_cdr(payload, stamp)
    assert serialized == cdr.encode(handler.to_ros(payload, stamp))
    for store in _STORES:
        theirs = store.deserialize_cdr(serialized, handler.message_type.__msgtype__)
        assert (theirs.header.stamp.sec, theirs.header.stamp.nanosec) == (stamp.sec, stamp.nanosec)
        assert theirs.header.frame_id == frame_id
        check(theirs, fields)
        _check_way_back(handler, theirs, store, payload)


def _check_way_back(handler: StandardHandler[Any, Any], theirs: Any, store: Typestore, payload: Any) -> None:
    """What the message tells of the payload is what the payload said, to the last bit."""
    data = bytes(store.serialize_cdr(theirs, handler.message_type.__msgtype__))
    if handler.route.topic == "gps/fix":
        with pytest.raises(ConversionError, match="STATUS_FIX for 'GPS_FIX' and for 'PPS_FIX'"):
            handler.from_cdr(data)
        return
    back = handler.from_cdr(data)
    for field, value in back.ListFields():
        assert value == getattr(payload, field.name)
    assert back.ListFields() or not any(value for field, value in payload.ListFields() if field.name in _told(handler))


def _told(handler: StandardHandler[Any, Any]) -> set[str]:
    """The fields of the payload that come back from a message in which every number is 1."""
    ones = handler.payload_type(
        **{f.name: 1.0 for f in handler.payload_type.DESCRIPTOR.fields if f.type == f.TYPE_FLOAT}
    )
    return {field.name for field, _ in handler.from_ros(handler.to_ros(ones)).ListFields()}


def test_a_number_too_large_for_the_payload_is_refused() -> None:
    """A float64 that no float32 holds does not become infinite on the way to a payload."""
    handler = _EXTRA_TOPICS["pressure/temperature"]
    with pytest.raises(ConversionError, match=r"^pressure_info on pressure/temperature: 1e\+300 is too large"):
        handler.from_cdr(cdr.encode(handler.message_type(temperature=1e300)))
    assert math.isinf(handler.from_cdr(cdr.encode(handler.message_type(temperature=math.inf))).temperature_c)


@pytest.mark.parametrize(
    ("angles", "parts"),
    [
        ((math.pi / 2, 0, 0), (math.sqrt(0.5), 0, 0, math.sqrt(0.5))),
        ((0, math.pi / 2, 0), (0, math.sqrt(0.5), 0, math.sqrt(0.5))),
        ((0, 0, math.pi), (0, 0, 1, 0)),
        ((math.pi / 2, 0, math.pi / 2), (0.5, 0.5, 0.5, 0.5)),
    ],
)
def test_quaternions_are_those_of_the_books(angles: Any, parts: Any) -> None:
    """Quarter turns, and one about x followed by one about the fixed z."""
    from roverlink.runtime.convert import rotations

    assert rotations.quaternion(*angles) == pytest.approx(parts, abs=1e-15)
