"""The pure core: datagrams to serialized messages and back, and every way in which a datagram is refused."""

from __future__ import annotations

import dataclasses
from typing import Any

import pytest
from strategies import delimited, varint

from generated.registry import REGISTRY
from roverlink.runtime import ConversionError, DatagramError, Reason, Translator
from roverlink.runtime.core.registry import AnyHandler
from roverlink.runtime.interfaces import Time

_INBOUND = [handler for handler in REGISTRY.handlers if handler.route.inbound]
_OUTBOUND = [handler for handler in REGISTRY.handlers if not handler.route.inbound]


def _name(handler: AnyHandler) -> str:
    return handler.route.name


def _refused(translator: Translator, datagram: bytes) -> DatagramError:
    with pytest.raises(DatagramError) as caught:
        translator.receive(datagram)
    return caught.value


def _envelope(**payloads: Any) -> bytes:
    return REGISTRY.envelope(**payloads).SerializeToString()


# --- peers to topics --------------------------------------------------------------------------------------------


_WITHOUT_IMU = dataclasses.replace(
    REGISTRY,
    handlers=tuple(handler for handler in REGISTRY.handlers if handler.route.name != "imu_info"),
    retired={28: "thermal_info"},
)


@pytest.mark.parametrize(
    ("datagram", "expected"),
    [
        (delimited(25, b"\x0d1234"), "no row of the table has payload 25"),
        (bytes.fromhex("ca01"), "no row of the table has payload 25"),  # stripped, and so not malformed
        (delimited(25, b"") + delimited(26, b"") + varint(27 << 3) + varint(1), "no row of the table has payload 26"),
        (delimited(28, b""), "no row of the table has payload 28 (retired: thermal_info)"),
        (_envelope(imu_info={}), "no handler for payload 13 ('imu_info'): the table does not bridge this payload"),
        (
            _envelope(imu_info={}) + delimited(99, b"x"),  # a field behind it does not lend it its number
            "no handler for payload 13 ('imu_info'): the table does not bridge this payload",
        ),
    ],
)
def test_an_unknown_payload_is_refused_with_its_number(datagram: bytes, expected: str) -> None:
    """The last number is told, named as it used to be, or as the envelope has it."""
    error = _refused(Translator(_WITHOUT_IMU), datagram)
    assert (error.reason, str(error)) == (Reason.UNKNOWN_PAYLOAD, expected)


@pytest.mark.parametrize(
    "datagram",
    [b"\xff" * 20, delimited(13, b"\x0d1234") + b"\x07", _envelope(imu_info={"accel_x": 1.0}) + b"\0\0\1"],
    ids=["ones", "trailing garbage", "garbage behind the padding"],
)
def test_a_malformed_datagram_is_refused_with_its_start(datagram: bytes, translator: Translator) -> None:
    """What is no envelope is quoted with its size and first bytes."""
    error = _refused(translator, datagram)
    assert error.reason is Reason.MALFORMED
    assert f"{len(datagram)} bytes" in str(error)
    assert datagram[:8].hex(" ") in str(error)


@pytest.mark.parametrize(
    ("payload", "expected"),
    [
        *(({"imu_info": {"error_code": n}}, f"13: imu_info.error_code: {n}") for n in (300, 256, -1)),
        ({"sensor_diag": {"gps_sensor_1": {"fix_quality": 999}}}, "11: sensor_diag.gps_sensor.fix_quality: 999"),
    ],
)
def test_an_enum_that_does_not_fit_is_refused(payload: Any, expected: str, translator: Translator) -> None:
    """A value that its ROS 2 field cannot hold is refused, with the path in the topic's names, and never cut off."""
    error = _refused(translator, _envelope(**payload))
    assert error.reason is Reason.CONVERSION
    assert str(error).startswith(f"payload {expected} does not fit uint8")


# --- batches ----------------------------------------------------------------------------------------------------


def test_a_batch_becomes_what_its_datagrams_become_alone(translator: Translator) -> None:
    """Names in the order of the datagrams, messages in the order of their row's, every refusal, and extra topics."""
    imu = [{"accel_x": 1.0}, {"error_code": 300}, {"accel_x": 3.0}, {"error_code": -1}]
    datagrams = [_envelope(imu_info=values) for values in imu] + [
        b"",
        b"\xff",
        _envelope(ph_info={}),
        delimited(25, b""),
    ]
    batch = translator.receive_all(datagrams, Time())
    assert batch.names == ["imu_info", None, "imu_info", None, None, None, "ph_info", None]
    alone = {place: translator.receive(datagrams[place])[1] for place in (0, 2, 6)}
    assert batch.messages == {"imu_info": [alone[0], alone[2]], "ph_info": [alone[6]]}
    refusals = [_refused(translator, datagrams[place]) for place in (1, 3, 4, 5, 7)]
    assert sorted(map(_told, batch.refusals)) == sorted(map(_told, refusals))
    fed = {handler.route.topic: len(payloads) for handler, payloads in batch.extra_topics}
    assert fed == {"imu/data_raw": 2, "imu/mag": 2, "ph/temperature": 1}


def _told(error: DatagramError) -> str:
    return f"{error.reason} {error.row}: {error}"


# --- topics to peers --------------------------------------------------------------------------------------------


def test_a_message_that_cannot_be_read_names_its_row(translator: Translator) -> None:
    """Bytes on a topic that are no such message are a `ConversionError` that names the row and the type."""
    handler = REGISTRY.by_name["drive_motor"]
    with pytest.raises(ConversionError, match=r"^drive_motor: too short for comms/msg/Driving"):
        translator.send(handler, bytes.fromhex("00010000 0000"))
    with pytest.raises(ConversionError, match=r"^drive_motor: not plain CDR"):
        translator.send(handler, b"")
