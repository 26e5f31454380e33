"""A bridge that spares a slow link: limits of forwards, a budget by priority, and only what has changed."""

from __future__ import annotations

import dataclasses
import socket
import struct
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from bridge_rig import QUIET, Rig, changed, end, envelope, listener, of_peers, waiting
from lines import cable
from polling import wait_until
from test_signed_bridge import SignedRig, signing

from generated.registry import REGISTRY
from roverlink.runtime import Registry
from roverlink.runtime.core.handler import Deadman, SendLimits
from roverlink.runtime.core.registry import EndName
from roverlink.runtime.net.carrier import Outgoing
from roverlink.runtime.net.outbox import Outbox, number_of, priority_by_number

_SO_TIMESTAMPNS = 35  # asm-generic/socket.h


def _imu(number: int) -> bytes:
    return envelope(imu_info={"accel_x": float(number)})


def _forwarding(**limits: Any) -> Registry:
    """The registry that forwards a row to the basestation with limits, and no other row."""
    quiet = QUIET
    for handler in QUIET.handlers:
        quiet = changed(quiet, handler.route.name, forward=())
    given = {"forward": ("basestation",), "forward_limits": (("basestation", SendLimits(**limits)),)}
    return changed(quiet, "imu_info", **given)


def _timed(sock: socket.socket) -> Iterator[tuple[float, bytes]]:
    """What has arrived at a socket, with the kernel's time of each datagram."""
    sock.setblocking(False)
    while True:
        try:
            datagram, ((_, _, stamp),), _, _ = sock.recvmsg(65_536, 64)
        except BlockingIOError:
            return
        seconds, nanoseconds = struct.unpack("qq", stamp)
        yield seconds + nanoseconds / 1e9, datagram


def test_a_forward_is_limited_where_its_topic_is_not() -> None:
    """Fifty a second come, five a second leave, the newest of them; the topic gets all, and each one is counted."""
    with Rig(_forwarding(max_rate=5)) as rig:
        base = rig.peers["basestation"]
        began = time.monotonic()
        for number in range(1, 51):
            rig.receive(_imu(number))
            time.sleep(0.02)
        account = rig.bridge.account
        wait_until(lambda: account.forwarded["basestation"] + account.withheld.total() == 50, "the newest")
        took, arrived = time.monotonic() - began, waiting(base)
        assert arrived[-1] == _imu(50)
        assert len(arrived) <= 1 + 5 * took
        assert account.withheld == {("basestation", "imu_info", "superseded"): 50 - len(arrived)}
        assert len(rig.on_topic["imu_data"]) == 50


def test_a_forward_gets_only_changes_and_the_last_one_again() -> None:
    """A state that does not change leaves once, and then as a heartbeat, although no board speaks any more."""
    with Rig(_forwarding(on_change=True, at_least_ms=300)) as rig:
        rig.receive(*[_imu(1)] * 5, _imu(2), _imu(1), _imu(1))
        assert waiting(rig.peers["basestation"])[:3] == [_imu(1), _imu(2), _imu(1)]
        assert rig.arrived("basestation", 2)[:2] == [_imu(1)] * 2
        assert rig.account.withheld == {("basestation", "imu_info", "unchanged"): 5}
        assert rig.account.forwarded == {"basestation": 3}
        wait_until(lambda: rig.account.repeated["imu_info"] >= 2, "the counts")


def test_a_row_is_sent_on_change_and_again_without_a_message() -> None:
    """Payloads are compared, so a message whose payload is the same does not leave; a heartbeat does."""
    with Rig(changed(QUIET, "drive_motor", send=SendLimits(on_change=True, at_least_ms=300))) as rig:
        kind = rig.registry.by_name["drive_motor"].payload_type
        one, two = kind(distance_to_go=1.0), kind(distance_to_go=2.0)
        first = rig.publish("drive_motor", one, one, one)
        second = rig.publish("drive_motor", two, two)
        assert rig.arrived("hardware", 4)[:4] == [first, second, second, second]
        assert (rig.account.sent["drive_motor"], rig.account.unchanged["drive_motor"]) == (2, 3)
        wait_until(lambda: rig.account.repeated["drive_motor"] >= 2, "the counts")


@pytest.mark.parametrize("budget", [None, 100_000])
def test_what_the_network_refused_is_not_the_state_that_an_end_has(tmp_path: Path, budget: int | None) -> None:
    """The same payload is sent as soon as there is a connection, and the one before counts as failed."""
    registry = changed(_forwarding(on_change=True), "detected_object", send=SendLimits(on_change=True))
    with Rig(of_peers(registry, basestation=end("base", f"serial:{tmp_path}/tty", budget=budget))) as rig:
        rig.receive(_imu(1))
        rig.publish("detected_object")
        with cable(tmp_path / "tty") as plugged:
            wait_until(lambda: rig.bridge.link_states()[EndName("basestation")].state == "ok", "a connection")
            rig.receive(_imu(1))
            rig.publish("detected_object")
            assert plugged.receive() == _imu(1)
            assert REGISTRY.envelope.FromString(plugged.receive()).HasField("detected_object")
        assert (rig.account.failed, rig.account.forwarded) == ({"detected_object": 1}, {"basestation": 1})


def _flooded(budget: int, **more: Any) -> Registry:
    """The registry that forwards a sensor to the basestation, which gets commands of priority 9 within a budget."""
    registry = of_peers(changed(QUIET, "imu_info", forward=("basestation",)), basestation={"budget": budget, **more})
    return changed(registry, "detected_object", priority=9)


def test_telemetry_stays_within_the_budget_and_holds_nothing_urgent() -> None:
    """Each second that the receiver sees has few enough bytes; each datagram has left, or is counted."""
    budget, datagram = 60_000, _imu(7)
    with Rig(_flooded(budget)) as rig:
        base = rig.peers["basestation"]
        base.setsockopt(socket.SOL_SOCKET, _SO_TIMESTAMPNS, 1)
        end, delays, log, commands = time.monotonic() + 2.5, list[float](), list[tuple[float, bytes]](), list[float]()

        def arrived() -> bool:
            new = [*_timed(base)]
            log.extend(new)
            commands.extend(at for at, got in new if got != datagram)
            return len(commands) > len(delays)

        while time.monotonic() < end:
            rig.receive(*[datagram] * 40)
            began = time.time()
            rig.publish("detected_object")
            wait_until(arrived, "the command")
            delays.append(commands[-1] - began)
        account, lost = rig.account, rig.account.undelivered_of_row
        given = account.forwarded["basestation"] + len(delays)
        wait_until(lambda: arrived() or len(log) + lost.total() == given, "the rest")
        assert {row for row, _ in lost} == {"imu_info"}
        assert {one[:2] for one in rig.bridge.account.undelivered} == {("basestation", "")}
        assert account.forwarded["basestation"] == len(log) - len(commands) + lost.total()
        assert account.sent["detected_object"] == len(delays) == len(commands)
        assert account.budget_bytes["basestation"] == sum(len(datagram) + 28 for _, datagram in log)
        first = sent = 0
        for at, got in log:
            sent += len(got) + 28
            while log[first][0] < at - 1:
                sent -= len(log[first][1]) + 28
                first += 1
            assert sent <= budget
        assert sorted(delays)[len(delays) // 2] < 0.25, delays  # what waits in turn waits for half a second


def test_an_urgent_datagram_overtakes_what_waits_for_a_line() -> None:
    """By the priority of its row, also if a signature is in front of the payload; the others keep their order."""
    registry, telemetry = dataclasses.replace(REGISTRY, signature=3), [_imu(number) for number in range(1, 6)]
    stop = b"\x1a\x01x" + envelope(drive_motor={"distance_to_go": 1.0})
    priority_of, went, free = priority_by_number(registry), list[bytes](), threading.Semaphore(0)
    with listener() as end, listener() as program:
        end.settimeout(None)
        send = lambda datagram: (went.append(datagram), free.acquire())  # noqa: E731
        outgoing = Outgoing(end, send, Outbox(lambda one: priority_of(number_of(one, 3))))  # type: ignore[arg-type]
        outgoing.start()
        for datagram in telemetry:
            program.sendto(datagram, end.getsockname())
        wait_until(lambda: went, "the first datagram")
        program.sendto(stop, end.getsockname())
        free.release(10)
        wait_until(lambda: len(went) == 6, "all datagrams")
        outgoing.close()
    assert went == [telemetry[0], stop, *telemetry[1:]]


def test_signatures_are_made_when_a_datagram_leaves(tmp_path: Path) -> None:
    """What leaves later has the later timestamp, so the peer accepts all; the budget counts the signatures."""
    with SignedRig(tmp_path, signing({"basestation": {"must_sign": True}}, _flooded(4_000))) as rig:
        rig.receive(*[_imu(7)] * 100)
        for _ in range(5):
            rig.publish("detected_object")
        rig.receive(*[_imu(8)] * 100)
        arrived: list[bytes] = []
        base, lost = rig.peers["basestation"], rig.account.undelivered_of_row
        wait_until(lambda: arrived.extend(waiting(base)) or len(arrived) + lost.total() == 205, "the rest")
        assert {rig.verdict("basestation", datagram) for datagram in arrived} == {"accepted"}
        assert rig.account.budget_bytes["basestation"] == sum(len(datagram) + 28 for datagram in arrived)
        assert lost


def test_the_stops_at_the_end_are_not_held_by_what_waits() -> None:
    """They leave before the bridge has closed, and what is too old then is counted; nothing hangs."""
    registry = changed(QUIET, "drive_motor", deadman=Deadman(3_600_000, {"distance_to_go": 1.0}))
    with Rig(of_peers(registry, hardware={"budget": 1_000})) as rig:
        board = rig.peers["hardware"].dup()
        for _ in range(40):
            rig.publish("arm_target")
    arrived, stop = waiting(board), envelope(drive_motor={"distance_to_go": 1.0})
    board.close()
    assert (arrived.count(stop), rig.account.stops["drive_motor"]) == (3, 3)
    assert len(arrived) - 3 + rig.account.undelivered_of_row["arm_target", "over_budget"] == 40


@pytest.mark.parametrize(("address", "headers"), [("127.0.0.1", 28), ("::1", 48)])
def test_the_headers_of_the_network_count(address: str, headers: int) -> None:
    """Those of IPv4 and UDP have 28 bytes, those of IPv6 and UDP 48."""
    with Rig(of_peers(QUIET, hardware={"budget": 1_000}), dst_ip=address) as rig:
        command = rig.publish("arm_target")
        assert rig.account.budget_bytes["hardware"] == len(command) + headers
