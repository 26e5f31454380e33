"""A whole bridge between real UDP sockets and topics in memory."""

from __future__ import annotations

import errno
import math
import re
import socket
from collections.abc import Iterable, Iterator, Sequence
from types import SimpleNamespace
from typing import Any

import pytest
from bridge_rig import INBOUND, OUTBOUND, Rig, envelope
from google.protobuf.message import DecodeError
from needs import needs_linux

from generated.registry import REGISTRY
from roverlink.generator.example_payloads import payload_at
from roverlink.runtime import MiddlewareError, Qos
from roverlink.runtime.core import cdr
from roverlink.runtime.core.messages import Message
from roverlink.runtime.core.registry import AnyHandler
from roverlink.runtime.interfaces import Time
from roverlink.runtime.middleware.memory import MemoryMiddleware
from roverlink.runtime.net import udp
from roverlink.runtime.ros_time.clock import SystemClock

_IMU = envelope(imu_info={})


def _filled(handler: AnyHandler) -> bytes:
    return envelope(**{handler.route.name: payload_at(handler.payload_type, 1.0)})


def _on(rig: Rig, topic: str) -> list[Any]:
    """The messages of a topic, as values."""
    return [cdr.decode(REGISTRY.by_topic[topic].message_type, data) for data in rig.on_topic[topic]]


@pytest.fixture
def rig() -> Iterator[Rig]:
    """A bridge as it is without any parameters."""
    with Rig() as rig:
        yield rig


# --- peers to topics --------------------------------------------------------------------------------------------


def test_every_inbound_message_reaches_its_topic_and_telemetry_the_basestation(rig: Rig) -> None:
    """Each payload is published once as its handler makes it; what the hardware says is forwarded byte by byte."""
    rig.receive(*map(_filled, INBOUND))
    for handler in INBOUND:
        assert rig.on_topic[handler.route.topic] == [handler.to_cdr(payload_at(handler.payload_type, 1.0))]
        assert rig.account.published[handler.route.name] == 1
    assert not rig.account.dropped.total()
    telemetry = [_filled(handler) for handler in INBOUND if handler.route.peer == "hardware"]
    assert (len(INBOUND), len(telemetry)) == (15, 12)
    assert (rig.arrived("basestation", 12), rig.arrived("hardware")) == (telemetry, [])
    assert rig.account.forwarded == {"basestation": 12}


@pytest.mark.parametrize("change", [lambda plain: plain.rstrip(b"\0"), lambda plain: plain + bytes(50)])
def test_trailing_zeros_are_understood_and_forwarded_intact(rig: Rig, change: Any) -> None:
    """A stripped or padded envelope is published as the plain one, and a strict decoder gets the plain one as well."""
    plain = envelope(load_cell_info={"mass_grams": 0.0, "is_calibrated": True, "tare_offset_counts": 256})
    plain += b"\x5a\0"  # number 11, empty: the payload that counts, and its length is a zero byte
    handler = REGISTRY.by_number[11]
    with pytest.raises(DecodeError):
        REGISTRY.envelope.FromString(change(plain))
    rig.receive(change(plain))
    assert rig.on_topic[handler.route.topic] == [handler.to_cdr(handler.payload_type())]
    assert rig.arrived("basestation", 1) == [plain]


# --- extra topics -----------------------------------------------------------------------------------------------


def test_a_datagram_feeds_every_topic_of_its_row(caplog: pytest.LogCaptureFixture) -> None:
    """An IMU's sample is on its own topic and on both of the standard ones, stamped by the clock of the bridge."""
    with Rig(clock=SystemClock(lambda: 1000 * 10**9 + 5)) as rig:
        rig.listen("imu/data_raw", "imu/mag")
        rig.receive(envelope(imu_info={"gyro_z": 90.0, "accel_x": 9.5, "mag_y": 50.0}))
    (own,), (imu,), (mag,) = _on(rig, "imu_data"), _on(rig, "imu/data_raw"), _on(rig, "imu/mag")
    assert (own.gyro_z, imu.linear_acceleration.x) == (90.0, 9.5)
    assert (imu.angular_velocity.z, mag.magnetic_field.y) == pytest.approx((math.pi / 2, 5e-5))
    assert imu.header == mag.header
    assert imu.header.stamp == Time(1000, 5)
    assert rig.account.extra_published == {"imu/data_raw": 1, "imu/mag": 1}
    assert "not published" not in caplog.text


def test_what_does_not_fit_an_extra_topic_is_counted_there(rig: Rig, caplog: pytest.LogCaptureFixture) -> None:
    """The row's own topic has the message; the extra topic has not, which is counted and warned of."""
    misfit = envelope(gps_info={"fix_quality": 9, "latitude": 1.5})
    rig.receive(misfit)  # without subscribers it is not even converted
    assert not rig.account.extra_unpublished
    rig.listen("gps/fix")
    rig.receive(misfit, envelope(gps_info={"fix_quality": 1, "latitude": 2.5}))
    assert [message.latitude for message in _on(rig, "gps_data")] == [1.5, 1.5, 2.5]
    assert [message.latitude for message in _on(rig, "gps/fix")] == [2.5]
    account = rig.account
    assert (account.extra_unpublished, account.extra_published) == ({"gps/fix": 1}, {"gps/fix": 1})
    assert not account.dropped.total()
    assert "not published: gps_info on gps/fix: fix_quality: 9 is not among the values that" in caplog.text


# --- topics to peers --------------------------------------------------------------------------------------------


def test_every_outbound_message_reaches_its_peer(rig: Rig) -> None:
    """A message on an outbound row's topic is sent to the row's peer, to it alone, as the plain envelope."""
    assert len(OUTBOUND) == 6
    for handler in OUTBOUND:
        datagram = rig.publish(handler.route.name, payload_at(handler.payload_type, 2.0))
        assert rig.arrived(handler.route.peer, 1) == [datagram]
        assert not any(rig.arrived(peer) for peer in rig.peers)
        assert rig.account.sent[handler.route.name] == 1


def test_the_policy_all_forwards_everything_to_everyone() -> None:
    """Every datagram, understood or not, goes raw and once to each peer, as it came."""
    rows = [_filled(REGISTRY.by_name[name]) for name in ("imu_info", "control_mode", "drive_motor")]
    datagrams = [*rows, bytes.fromhex("ca01"), _IMU + bytes(100), b"\xff\xff\xff", b""]
    with Rig(forward_policy="all") as rig:
        rig.receive(*datagrams)
        assert all(rig.arrived(peer, len(datagrams)) == datagrams for peer in rig.peers)
        assert rig.account.forwarded == dict.fromkeys(rig.peers, len(datagrams))
        assert rig.account.published == {"imu_info": 2, "control_mode": 1}


# --- what is not bridged ----------------------------------------------------------------------------------------


def test_each_reason_is_counted_and_warned_of(rig: Rig, caplog: pytest.LogCaptureFixture) -> None:
    """What cannot be bridged is counted by its reason, warned of once in two seconds, and not forwarded."""
    direction = r"dropped: 'arm_ctrl' \(2\) is a message to a peer \(ros_to_hardware\)"
    bad = {
        "empty": (b"", r"dropped: the PBEnvelope has no payload \(0 bytes\)"),
        "malformed": (b"\xff" * 9, r"dropped: not a valid PBEnvelope: 9 bytes starting with ff ff"),
        "unknown_payload": (bytes.fromhex("ca0100"), r"dropped: no row of the table has payload 25$"),
        "wrong_direction": (envelope(arm_ctrl={}), direction),
        "conversion": (envelope(imu_info={"error_code": 300}), r"dropped: payload 13: imu_info\.error_code: 300"),
        "oversized": (bytes(1473), r"dropped: a datagram of more than 1472 bytes"),
    }
    for datagram, _ in bad.values():
        rig.receive(datagram, _IMU, datagram)
    assert rig.account.dropped == dict.fromkeys(bad, 2)
    assert rig.account.published == {"imu_info": len(bad)}
    for _, expected in bad.values():
        assert len([message for message in caplog.messages if re.match(expected, message)]) == 1, expected
    assert (rig.arrived("basestation", len(bad)), rig.arrived("hardware")) == ([_IMU] * len(bad), [])


@pytest.mark.parametrize("policy", ["mapping", "all"])
def test_the_longest_datagram_passes_and_a_longer_one_does_not(policy: str) -> None:
    """`max_datagram` is the longest that is taken; what is longer is not even forwarded, cut as it would be."""
    plain = envelope(imu_info={"accel_x": 1.0})
    longest = plain.ljust(60, b"\0")
    with Rig(max_datagram=60, forward_policy=policy) as rig:
        rig.receive(longest, longest + b"\0", bytes(5000))
        assert (rig.account.published, rig.account.dropped) == ({"imu_info": 1}, {"oversized": 2})
        assert rig.arrived("basestation", 1) == [longest if policy == "all" else plain]


class _Slow(MemoryMiddleware):
    """A middleware that accepts the first message and no more."""

    def publisher(self, topic: str, message_type: type[Message], qos: Qos) -> Any:
        accepted: list[bytes] = []

        def publish(messages: Sequence[bytes]) -> int:
            room = min(1 - len(accepted), len(messages))
            accepted.extend(messages[:room])
            return room

        return SimpleNamespace(publish=publish, has_subscribers=lambda: True)


def test_what_the_middleware_does_not_accept_is_counted(caplog: pytest.LogCaptureFixture) -> None:
    """A message for which the bridge would have had to wait is counted and told by name, and not as published."""
    with Rig(middleware=_Slow) as rig:
        rig.receive(*[_IMU] * 20, envelope(gps_info={}))
        assert rig.account.published == {"imu_info": 1, "gps_info": 1}
        assert rig.account.dropped == {"not_published": 19}
        assert len(rig.arrived("basestation", 21)) == 21
    assert "dropped: imu_info (13): a subscriber is too slow" in caplog.text


# --- starting and stopping --------------------------------------------------------------------------------------


def test_stopping_handles_what_had_arrived_and_may_be_repeated() -> None:
    """Everything that arrived before the stop is bridged; a later signal is no error."""
    rig = Rig()
    rig.send(*[_IMU] * 200)
    rig.bridge.stop()
    with rig:
        rig.bridge.run()
        assert rig.account.received == rig.account.published["imu_info"] == 200
        assert len(rig.arrived("basestation", 200)) == 200
        rig.bridge.stop()
    rig.bridge.stop()


class _Stale(MemoryMiddleware):
    """A ROS 2 with other message types; it has no topics before that is known."""

    def check_types(self, message_types: Iterable[type[Message]]) -> None:
        raise MiddlewareError(f"{len(list(message_types))} message types are not the generated ones")

    def publisher(self, topic: str, message_type: type[Message], qos: Qos) -> Any:
        pytest.fail("a publisher was opened")

    subscribe = publisher  # type: ignore[assignment]  # neither is called


def test_message_types_are_checked_before_any_topic_is_open() -> None:
    """All rows and extra topics are checked; the bridge does not start, and passes nothing on."""
    count = len(REGISTRY.handlers) + len(REGISTRY.extra_topics)
    with pytest.raises(MiddlewareError, match=rf"^{count} message types"), Rig(middleware=_Stale):
        pass


# --- the network ------------------------------------------------------------------------------------------------


def test_a_network_that_refuses_is_counted_and_does_not_stop_the_bridge(caplog: pytest.LogCaptureFixture) -> None:
    """Where sending fails, messages are published all the same; each datagram is counted and the reason told."""
    with Rig(dst_ip="255.255.255.255") as rig:  # a broadcast, which nobody allowed
        rig.receive(*[_IMU] * 5)
        rig.publish("drive_motor")
        assert rig.account.published == {"imu_info": 5}
        assert rig.account.unsent == {"basestation": 5, "hardware": 1}
        assert rig.account.forwarded == rig.account.sent == {}
    assert "cannot send to basestation at 255.255.255.255:" in caplog.text
    assert "Permission denied" in caplog.text


def test_a_network_that_comes_back_is_used_again(rig: Rig, monkeypatch: pytest.MonkeyPatch) -> None:
    """After the network has changed, and a connected socket no longer works, datagrams find the new way."""

    def gone(*_: object) -> int:
        raise OSError(errno.ENETUNREACH, "Network is unreachable")

    for way in ("send", "sendmsg"):  # of a socket that is connected
        monkeypatch.setattr(socket.socket, way, gone)
    datagrams = [envelope(imu_info={"accel_x": float(number)}) for number in range(3)]
    for datagram in datagrams:
        rig.receive(datagram)
    assert (rig.account.unsent, rig.account.forwarded) == ({"basestation": 1}, {"basestation": 2})
    assert rig.arrived("basestation", 2) == datagrams[1:]


@needs_linux  # whose kernel counts them
def test_what_the_kernel_dropped_is_in_the_account(caplog: pytest.LogCaptureFixture) -> None:
    """Datagrams that came faster than they were read are counted and warned of: nothing is lost in silence."""
    rig = Rig(receive_buffer=4096)
    rig.send(*[_IMU] * 1000)
    with rig:
        rig.bridge.stop()
        rig.bridge.run()
    assert 0 < rig.account.received < 1000
    assert rig.account.received + rig.account.kernel_drops == 1000
    assert f"the kernel dropped {rig.account.kernel_drops} datagrams" in caplog.text


def test_a_receive_buffer_that_is_not_given_is_told(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """Where the system gives a smaller buffer than was asked for, the operator is told how to raise it."""
    monkeypatch.setattr(udp, "receive_buffer", lambda sock: 212_992)
    with Rig(receive_buffer=4_000_000):
        pass
    assert "the UDP receive buffer has 212992 bytes instead of 4000000" in caplog.text
    assert "sysctl -w net.core.rmem_max=4000000" in caplog.text
