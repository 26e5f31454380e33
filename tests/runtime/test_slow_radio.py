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
from bridge_rig import QUIET, Rig, changed, end, envelope, listener, of_peers, port_of, waiting
from lines import cable
from linked import linked_registry
from polling import PATIENCE_S, wait_until
from test_signed_bridge import NUMBER, SignedRig, signing

from generated.registry import REGISTRY
from roverlink.generator.example_payloads import payload_at
from roverlink.runtime import Registry
from roverlink.runtime.core.handler import Deadman, SendLimits
from roverlink.runtime.core.link_message import LinkWriter
from roverlink.runtime.core.registry import EndName
from roverlink.runtime.core.signing import Key, Signer, SigningClock, Verifier, size_of_signature
from roverlink.runtime.net.carrier import Carrier
from roverlink.runtime.net.outbox import Outbox, number_of, priority_by_number

_SO_TIMESTAMPNS = 35  # asm-generic/socket.h
_ROCK = payload_at(REGISTRY.by_name["detected_object"].payload_type, 1.0)


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


@pytest.mark.slow
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


@pytest.mark.slow
def test_only_changes_leave_and_the_last_one_again() -> None:
    """A state that does not change leaves once, and then as a heartbeat, although nothing new comes any more.

    Payloads are compared, so a message whose payload is the same does not leave.
    """
    limits = {"on_change": True, "at_least_ms": 300}
    with Rig(changed(_forwarding(**limits), "drive_motor", send=SendLimits(**limits))) as rig:
        rig.receive(*[_imu(1)] * 5, _imu(2), _imu(1), _imu(1))
        assert waiting(rig.peers["basestation"])[:3] == [_imu(1), _imu(2), _imu(1)]
        one, two = (rig.registry.by_name["drive_motor"].payload_type(distance_to_go=far) for far in (1.0, 2.0))
        first, second = rig.publish("drive_motor", one, one, one), rig.publish("drive_motor", two, two)
        assert rig.arrived("hardware", 4)[:4] == [first, second, second, second]
        assert rig.arrived("basestation", 2)[:2] == [_imu(1)] * 2
        assert rig.account.withheld == {("basestation", "imu_info", "unchanged"): 5}
        assert rig.account.forwarded == {"basestation": 3}
        assert (rig.account.sent["drive_motor"], rig.account.unchanged["drive_motor"]) == (2, 3)
        wait_until(lambda: min(rig.account.repeated[row] for row in ("imu_info", "drive_motor")) >= 2, "the counts")


@pytest.mark.parametrize("budget", [None, 100_000])
def test_who_comes_later_gets_the_last_state_once(tmp_path: Path, budget: int | None) -> None:
    """After each reconnection, what was last to be forwarded and sent comes, and only that; the same again does not."""
    registry = changed(_forwarding(on_change=True), "detected_object", send=SendLimits(on_change=True))
    with Rig(of_peers(registry, basestation=end("base", f"serial:{tmp_path}/tty*", budget=budget))) as rig:
        rig.receive(_imu(1), _imu(2))
        states = {_imu(2), rig.publish("detected_object", _ROCK)}
        assert rig.account.failed == {"detected_object": 1}
        for life in range(3):
            with cable(tmp_path / f"tty{life}") as plugged:
                assert {plugged.receive(), plugged.receive()} == states
                rig.receive(_imu(2))
                rig.publish("detected_object", _ROCK)
        wait_until(lambda: rig.account.repeated.total() == 6, "the counts")
        assert (rig.account.unchanged, rig.account.withheld.total()) == ({"detected_object": 3}, 3)


@pytest.mark.slow
def test_a_program_that_has_started_again_gets_the_last_state() -> None:
    """Its link messages have a new session, and the next link message of the bridge brings the state."""
    registry = changed(linked_registry(), "drive_command", send=SendLimits(on_change=True))
    assert registry.link is not None
    with Rig(registry) as rig:
        command = rig.publish("drive_command", registry.by_name["drive_command"].payload_type(speed=1))
        for session in (7, 8):
            rig.receive(LinkWriter(registry.envelope, session, {2: registry.link.hashes[2]}).write(1))
            wait_until(lambda n=session: rig.account.repeated["drive_command"] >= n - 6, "the state")
        assert rig.arrived("hardware").count(command) == 3


def _flooded(budget: int, **more: Any) -> Registry:
    """The registry that forwards a sensor to the basestation, which gets commands of priority 9 within a budget."""
    registry = of_peers(changed(QUIET, "imu_info", forward=("basestation",)), basestation={"budget": budget, **more})
    return changed(registry, "detected_object", priority=9)


@pytest.mark.slow
def test_telemetry_stays_within_the_budget_and_holds_nothing_urgent() -> None:
    """Each second that the receiver sees has few enough bytes; each datagram has left, or is counted."""
    budget, telemetry, rounds = 10_000, _imu(1)[:2], 0
    with Rig(_flooded(budget)) as rig:
        base = rig.peers["basestation"]
        base.setsockopt(socket.SOL_SOCKET, _SO_TIMESTAMPNS, 1)
        account, end, log = rig.account, time.monotonic() + 2.5, list[tuple[float, bytes]]()

        def commands() -> list[int]:
            log.extend(_timed(base))
            return [place for place, (_, got) in enumerate(log) if got[:2] != telemetry]

        while time.monotonic() < end:
            rounds += 1
            rig.receive(*[_imu(rounds)] * 40)
            rig.publish("detected_object")
            wait_until(lambda wanted=rounds: len(commands()) == wanted, "the command")  # type: ignore[misc]

        def is_settled() -> bool:
            commands()
            counted = account.forwarded["basestation"], account.sent["detected_object"]
            bytes_sent = sum(len(got) + 28 for _, got in log)
            return (
                len(log) + account.undelivered_of_row.total() == 41 * rounds
                and counted == (40 * rounds, rounds)
                and account.budget_bytes["basestation"] == bytes_sent
            )

        wait_until(is_settled, "the rest, and the counts")
        assert {row for row, _ in account.undelivered_of_row} == {"imu_info"}
        assert {one[:2] for one in rig.bridge.account.undelivered} == {("basestation", "")}
        first = sent = 0
        for at, got in log:
            sent += len(got) + 28
            while log[first][0] < at - 1:
                sent -= len(log[first][1]) + 28
                first += 1
            assert sent <= budget
        # A command that waited in turn would come after all telemetry that had been there before it.
        parse, overtaken = rig.registry.envelope.FromString, 0
        for number, place in enumerate(commands(), 1):
            behind = next((parse(got) for _, got in log[place:] if got[:2] == telemetry), None)
            overtaken += behind is not None and behind.imu_info.accel_x <= number
        assert overtaken > rounds / 2


class _Line:
    """Transport, and its connection, which takes a datagram when the test lets it."""

    name, largest, refused = "line", 1000, 0

    def __init__(self) -> None:
        self.went, self.free, self._closed = list[bytes](), threading.Semaphore(0), threading.Event()

    def connect(self) -> Any:
        return self

    def receive(self, timeout: float) -> list[bytes]:
        self._closed.wait(timeout)
        return []

    def send(self, datagram: bytes) -> None:
        self.went.append(datagram)
        self.free.acquire()

    def close(self) -> None:
        self._closed.set()


def test_an_urgent_datagram_overtakes_what_waits_for_a_line() -> None:
    """By the priority of its row, behind the signature of a sender, too; the others keep their order.

    The signatures of the bridge are made in the order in which the datagrams leave.
    """
    registry, telemetry = dataclasses.replace(REGISTRY, signature=3), [_imu(number) for number in range(1, 6)]
    stop = b"\x1a\x01x" + envelope(drive_motor={"distance_to_go": 1.0})
    priority_of, line, key = priority_by_number(registry), _Line(), Key(1, "ros", bytes(32))
    outbox: Outbox[bytes] = Outbox(lambda one: priority_of(number_of(one, 3)))
    with listener() as program:
        carrier = Carrier(line, program, outbox=outbox, sign=Signer(3, key, SigningClock()).sign)
        carrier.start()
        carrier.wait(PATIENCE_S)
        for datagram in telemetry:
            program.sendto(datagram, carrier.address)
        wait_until(lambda: line.went, "the first datagram")
        program.sendto(stop, carrier.address)
        line.free.release(10)
        wait_until(lambda: len(line.went) == 6, "all datagrams")
        carrier.close()
    verifier = Verifier(3, [(key, 0, SigningClock())])
    assert [verifier.verify(datagram, {"ros"}) for datagram in line.went] == ["ros"] * 6
    assert [one[: -size_of_signature(3)] for one in line.went] == [telemetry[0], stop, *telemetry[1:]]


def test_what_leaves_over_a_line_is_signed_once(tmp_path: Path) -> None:
    """Commands and forwarded datagrams over a serial line, and over UDP when the parameter says so.

    What another program of this computer sends to the line, or what the policy `all` hands on, gets no signature.
    """
    registry = changed(QUIET, "imu_info", forward=("basestation",))
    with cable(tmp_path / "tty") as plugged:
        host = end("base", f"serial:{tmp_path}/tty", must_sign=True)
        with SignedRig(tmp_path, signing({"basestation": host}, registry)) as rig:
            wait_until(lambda: rig.bridge.link_states()[EndName("basestation")].state == "ok", "a connection")
            (line,) = rig.bridge._ends.lines()
            rig.board.sendto(envelope(detected_object={}), line[:2])
            rig.live.change({"forward_policy": "all"})
            rig.receive(_imu(3))
            rig.live.change({"forward_policy": "mapping"})
            assert [rig.verdict("basestation", plugged.receive()) for _ in range(2)] == ["unsigned"] * 2
            for arrived in (plugged.receive, lambda: rig.next("basestation")):
                rig.receive(_imu(1))
                command, both = rig.publish("detected_object", _ROCK), [arrived(), arrived()]
                assert {rig.verdict("basestation", one) for one in both} == {"accepted"}
                assert {one[: -size_of_signature(NUMBER)] for one in both} == {_imu(1), command}
                rig.live.change({"base_host": "127.0.0.1", "base_port": port_of(rig.peers["basestation"])})


@pytest.mark.slow
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
