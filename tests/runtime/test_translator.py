"""The pure core: datagrams to serialized messages and back, and every way in which a datagram is refused."""

from __future__ import annotations

import dataclasses
import struct
from collections import Counter
from collections.abc import Iterable, Iterator
from typing import Any

import pytest
from datagrams import hostile
from hypothesis import given, settings
from hypothesis import strategies as st
from strategies import delimited, payloads, varint

from generated.registry import REGISTRY
from roverlink.runtime import ConversionError, DatagramError, Reason, Registry, Translator
from roverlink.runtime.core import cdr
from roverlink.runtime.core.handler import all_to_cdr
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


@pytest.mark.parametrize("handler", _INBOUND, ids=_name)
@settings(max_examples=15)
@given(data=st.data())
def test_an_inbound_payload_becomes_its_message(handler: AnyHandler, data: st.DataObject) -> None:
    """What a peer sends is named after its row and has the bytes that the handler makes of it."""
    payload = data.draw(payloads(handler.payload_type))
    name, message = Translator(REGISTRY).receive(_envelope(**{handler.route.name: payload}))
    assert name == handler.route.name
    assert message == cdr.encode(handler.to_ros(payload))


@pytest.mark.parametrize("handler", _OUTBOUND, ids=_name)
def test_a_payload_that_never_comes_from_a_peer_is_refused(handler: AnyHandler, translator: Translator) -> None:
    """A payload on the wrong side is refused with its number, its name and its direction."""
    error = _refused(translator, _envelope(**{handler.route.name: handler.payload_type()}))
    assert error.reason is Reason.WRONG_DIRECTION
    assert f"{handler.route.name!r} ({handler.route.number}) is a message to a peer ({handler.route.direction})" in str(
        error
    )


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


@pytest.mark.parametrize("datagram", [b"", bytes(1), bytes(200)], ids=["nothing", "one zero", "zeros"])
def test_an_envelope_without_a_payload_is_empty(datagram: bytes, translator: Translator) -> None:
    """No bytes, or a buffer of zeros, is an empty envelope, told with its size."""
    error = _refused(translator, datagram)
    assert error.reason is Reason.EMPTY
    assert f"({len(datagram)} bytes)" in str(error)
    assert "PBEnvelope" in str(error)


@pytest.mark.parametrize(
    "datagram",
    [
        b"\xff" * 20,
        b"hello, rover",
        delimited(13, b"\x0d"),
        delimited(13, b"\x0d1234") + b"\x07",
        varint(13 << 3 | 2) + varint(2**40),
        _envelope(imu_info={"accel_x": 1.0}) + b"\0\0\1",
    ],
    ids=["ones", "text", "payload cut short", "trailing garbage", "absurd length", "garbage behind the padding"],
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


def test_an_enum_value_that_nobody_declared_passes_where_it_fits(translator: Translator) -> None:
    """A newer board may say something that this program has no name for; the number is handed on."""
    _, message = translator.receive(_envelope(imu_info={"error_code": 255}))
    assert cdr.decode(REGISTRY.by_name["imu_info"].message_type, message).error_code == 255


def test_of_several_payloads_the_last_one_counts(translator: Translator) -> None:
    """As protobuf has it for a oneof; unknown fields of a newer envelope beside it are ignored."""
    plain = _envelope(ph_info={"voltage": 1.0})
    newer = _envelope(imu_info={}) + delimited(99, b"new") + plain + varint(98 << 3) + varint(7)
    assert translator.receive(newer) == translator.receive(plain)
    assert translator.receive(plain)[0] == "ph_info"


# --- batches ----------------------------------------------------------------------------------------------------


def _one_by_one(translator: Translator, datagrams: Iterable[bytes]) -> Iterator[tuple[str, bytes] | str]:
    """What becomes of each datagram alone: name and message, or the refusal."""
    for datagram in datagrams:
        try:
            yield translator.receive(datagram)
        except DatagramError as error:
            yield f"{error.reason} {error.row}: {error}"


@settings(max_examples=15)
@given(seed=st.integers(0, 2**32 - 1), count=st.integers(0, 20))
def test_a_batch_becomes_what_its_datagrams_become_alone(seed: int, count: int) -> None:
    """Names in the order of the datagrams, messages in the order of their row's, and every refusal."""
    translator = Translator(REGISTRY)
    datagrams = list(hostile(REGISTRY, count, seed))
    batch = translator.receive_all(datagrams, Time())
    alone = list(_one_by_one(translator, datagrams))
    assert batch.names == [None if isinstance(one, str) else one[0] for one in alone]
    messages: dict[str, list[bytes]] = {}
    for one in alone:
        if not isinstance(one, str):
            messages.setdefault(one[0], []).append(one[1])
    assert batch.messages == messages
    refusals = [f"{error.reason} {error.row}: {error}" for error in batch.refusals]
    assert sorted(refusals) == sorted(one for one in alone if isinstance(one, str))


@pytest.mark.parametrize("error", [struct.error, OverflowError, TypeError, ValueError, ConversionError])
def test_however_a_payload_misfits_it_alone_is_told(error: type[Exception]) -> None:
    """Whatever converting raises for a value, a batch comes back with what fits, and with places for the rest."""
    handler_type = type(REGISTRY.by_name["imu_info"])

    class Particular(handler_type):  # type: ignore[misc,valid-type]  # its class is generated
        @staticmethod
        def _pack(payload: Any) -> bytes:
            return bytes(cdr.encode(Particular.to_ros(payload)))

        @staticmethod
        def to_ros(payload: Any) -> Any:
            if payload.error_code == 7:
                raise error("not this one")
            return handler_type.to_ros(payload)

    payloads = [handler_type.payload_type(error_code=code) for code in (1, 7, 2, 7)]
    messages, misfits = all_to_cdr(Particular(), payloads)
    assert messages == [REGISTRY.by_name["imu_info"].to_cdr(payload) for payload in payloads[::2]]
    assert {place: str(misfit) for place, misfit in misfits.items()} == dict.fromkeys((1, 3), "imu_info: not this one")


def test_a_payload_that_misfits_leaves_those_around_it_alone(translator: Translator) -> None:
    """In a batch of one row, what cannot be converted is refused at its place; the extra_topics get the others too."""
    imu = [{"accel_x": 1.0}, {"error_code": 300}, {"accel_x": 3.0}, {"error_code": -1}]
    batch = translator.receive_all([_envelope(imu_info=values) for values in imu], Time())
    assert batch.names == ["imu_info", None, "imu_info", None]
    assert [error.reason for error in batch.refusals] == [Reason.CONVERSION] * 2
    fits = [imu[0], imu[2]]
    assert batch.messages == {"imu_info": [translator.receive(_envelope(imu_info=values))[1] for values in fits]}
    assert {handler.route.topic: len(payloads) for handler, payloads in batch.extra_topics} == {
        "imu/data_raw": 2,
        "imu/mag": 2,
    }


# --- hostile input ----------------------------------------------------------------------------------------------


def _survives(registry: Registry, count: int, seed: int) -> Counter[Reason | None]:
    """What became of hostile datagrams, by the reason of each refusal; None for those that passed."""
    translator = Translator(registry)
    outcomes: Counter[Reason | None] = Counter()
    for datagram in hostile(registry, count, seed):
        try:
            name, message = translator.receive(datagram)
        except DatagramError as error:
            outcomes[error.reason] += 1
        else:
            outcomes[None] += 1
            assert message == cdr.encode(cdr.decode(registry.by_name[name].message_type, message))
    assert outcomes.total() == count
    return outcomes


def test_hostile_datagrams_raise_nothing_but_datagram_errors(registry: Registry) -> None:
    """Five thousand random and damaged datagrams are passed or refused, and every reason of the core occurs."""
    outcomes = _survives(registry, 5_000, seed=2)
    core = {Reason.EMPTY, Reason.MALFORMED, Reason.UNKNOWN_PAYLOAD, Reason.WRONG_DIRECTION, Reason.CONVERSION}
    assert set(outcomes) == core | {None}


@pytest.mark.exhaustive
@pytest.mark.parametrize("seed", [2, 3])
def test_a_million_hostile_datagrams(registry: Registry, seed: int) -> None:
    """The same, half a million at a time, so that two workers share them."""
    assert _survives(registry, 500_000, seed).total() == 500_000


# --- topics to peers --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("handler", REGISTRY.handlers, ids=_name)
@settings(max_examples=5)
@given(data=st.data())
def test_a_message_becomes_the_datagram_of_its_row(handler: AnyHandler, data: st.DataObject) -> None:
    """What is sent is the plain envelope, or the same without its trailing zeros where its peer's link says so."""
    payload = data.draw(payloads(handler.payload_type))
    plain = _envelope(**{handler.route.name: payload})
    for peer in REGISTRY.peers:
        peers = tuple(dataclasses.replace(one, strip_trailing_zeros=one is peer) for one in REGISTRY.peers)
        translator = Translator(dataclasses.replace(REGISTRY, peers=peers))
        sent = translator.send(handler, handler.to_cdr(payload))
        assert sent == (plain.rstrip(b"\0") if handler.route.peer == peer.name else plain)
        assert translator.parse(sent).SerializeToString() == plain


def test_a_message_that_cannot_be_read_names_its_row(translator: Translator) -> None:
    """Bytes on a topic that are no such message are a `ConversionError` that names the row and the type."""
    handler = REGISTRY.by_name["drive_motor"]
    with pytest.raises(ConversionError, match=r"^drive_motor: 6 bytes are too short for comms/msg/Driving"):
        translator.send(handler, bytes.fromhex("00010000 0000"))
    with pytest.raises(ConversionError, match=r"^drive_motor: not plain CDR"):
        translator.send(handler, b"")
