"""A bridge whose table has the link message compares schemas with its peers, and measures the link."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Mapping, Sequence
from typing import Any

import pytest
from bridge_rig import Rig, of_peers, port_of
from linked import linked_registry
from polling import wait_until

from roverlink.generator.ir import largest_link_size
from roverlink.runtime import DatagramError, Registry, SetupError
from roverlink.runtime.bridge.link_exchange import DIFFERS, SAME, UNKNOWN, EndReport
from roverlink.runtime.client import BlockingPeer
from roverlink.runtime.core import link_message
from roverlink.runtime.core.link_message import LinkWriter
from roverlink.runtime.core.registry import End, EndName
from roverlink.runtime.core.translator import Translator

_HARDWARE, _BASE = EndName("hardware"), EndName("base")
_ARM, _DRIVE = EndName("hardware", "Arm"), EndName("hardware", "Drive")
_DRIVE_ROWS, _BASE_ROWS = [2, 3], [4, 5, 1]


def _hashes() -> Mapping[int, int]:
    link = linked_registry().link
    assert link is not None
    return link.hashes


def _rig(registry: Registry | None = None, **given: Any) -> Rig:
    """A bridge of the small rover with the link message."""
    return Rig(registry or linked_registry(), **given)


def _report(rig: Rig, end: EndName) -> EndReport:
    """What the bridge knows about an end."""
    (report,) = [report for report in rig.bridge.link_reports() if report.end == end]
    return report


def _schemas(rig: Rig) -> dict[EndName, str]:
    return {report.end: report.schema for report in rig.bridge.link_reports()}


def _heard(rig: Rig, peer: str = "hardware") -> Any:
    """The next link message that a peer gets."""
    while True:
        envelope = rig.registry.envelope.FromString(rig.peers[peer].recv(2000))
        if envelope.WhichOneof("payload") == "link":
            return envelope.link  # type: ignore[attr-defined]


def _board(numbers: Sequence[int], other: Mapping[int, int] | None = None, session: int | None = None) -> LinkWriter:
    """A program that speaks some rows, with another hash of those in ``other``."""
    hashes = {number: _hashes().get(number, 0) for number in numbers} | dict(other or {})
    return LinkWriter(linked_registry().envelope, session or link_message.new_session(), hashes)


def _now_us() -> int:
    return time.monotonic_ns() // 1000


def _payload(name: str) -> bytes:
    return linked_registry().envelope(**{name: {}}).SerializeToString()


# --- schemas ----------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_the_bridge_says_its_rows_at_once_to_each_peer() -> None:
    """Each peer gets the hashes of its rows and of those forwarded to it, its own first, and then once a second."""
    with _rig() as rig:
        first, base = _heard(rig), _heard(rig, "base")
        second = _heard(rig)
    assert dict(zip(first.numbers, first.hashes)) == {number: _hashes()[number] for number in (1, 2, 3)}
    assert list(base.numbers) == _BASE_ROWS
    assert first.session == second.session == base.session != 0
    assert (first.sequence, second.sequence, base.sequence) == (1, 2, 1)
    assert (first.sent, second.sent) == (0, 1)
    assert 900_000 < second.time_us - first.time_us < 10_000_000


def test_the_sender_is_told_by_its_rows() -> None:
    """A board, the basestation, or one program with all rows of a peer: each is found by the rows that it says."""
    with _rig() as rig:
        assert _schemas(rig) == dict.fromkeys((_ARM, _DRIVE, _BASE), UNKNOWN)
        rig.receive(_board(_DRIVE_ROWS).write(1), _board(_BASE_ROWS).write(1))
        assert _schemas(rig) == {_ARM: UNKNOWN, _DRIVE: SAME, _BASE: SAME}
        rig.receive(_board([1, 2, 3]).write(1))
        assert _schemas(rig) == {_HARDWARE: SAME, _BASE: SAME}


def test_a_sender_without_a_row_of_the_table_is_told(caplog: pytest.LogCaptureFixture) -> None:
    """A link message from which nobody can tell who sent it is logged once, and forgotten."""
    with _rig() as rig:
        stranger = _board([77, 78])
        rig.receive(stranger.write(1), stranger.write(2), _board([]).write(3))
        assert set(_schemas(rig).values()) == {UNKNOWN}
    assert next(line for line in caplog.messages if "sender is unknown" in line).endswith("its sender is unknown")


def test_a_board_with_another_schema_is_named_once(caplog: pytest.LogCaptureFixture) -> None:
    """The rows that differ are named, with the board, once for each start of the board; the messages are passed on."""
    with _rig() as rig:
        board = _board(_DRIVE_ROWS, {2: 99})
        rig.receive(board.write(1), board.write(2), _payload("drive_state"))
        report = _report(rig, _DRIVE)
        assert (report.schema, report.differing) == (DIFFERS, ("drive_state",))
        assert _report(rig, _ARM).schema == UNKNOWN
        assert rig.account.published["drive_state"] == 1
        rig.receive(_board(_DRIVE_ROWS, {2: 99}).write(1))
    assert [line for line in caplog.messages if "schema" in line] == [
        "Drive of hardware has another schema of drive_state (2): messages are passed on; values may be misread "
        f"(parameter link_policy){more}"
        for more in ("", " (and 1 more like it)")
    ]


def test_rows_that_differ_are_refused_in_both_directions_if_the_policy_says_so() -> None:
    """With `refuse`, datagrams of such a row are dropped with a reason, and its commands are not sent."""
    with _rig(link_policy="refuse") as rig:
        account = rig.account
        rig.receive(_board(_DRIVE_ROWS, {2: 99, 3: 98}).write(1))
        rig.receive(_payload("drive_state"), _payload("arm_state"))
        rig.publish("drive_command")
        assert account.dropped["other_schema"] == account.dropped_of_row["drive_state", "other_schema"] == 1
        assert account.published == {"arm_state": 1}
        assert (account.refused["drive_command"], account.sent.total()) == (1, 0)
        rig.live.change({"link_policy": "warn"})
        rig.receive(_payload("drive_state"))
        rig.publish("drive_command")
        assert (account.published["drive_state"], account.sent["drive_command"]) == (1, 1)


def test_a_row_that_differs_at_the_receiver_of_forwarded_datagrams_is_only_not_forwarded() -> None:
    """The topic still gets a row that the basestation would misread, but the basestation does not."""
    with _rig(link_policy="refuse") as rig:
        rig.receive(_board(_BASE_ROWS, {1: 99}).write(1))
        rig.receive(_payload("arm_state"))
        assert _report(rig, _BASE).differing == ("arm_state",)
        assert rig.account.published["arm_state"] == rig.account.unforwarded["base"] == 1
        assert rig.account.forwarded["base"] == 0


def test_a_board_that_was_flashed_again_is_trusted_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """A new session of the same board takes the place of the silent old one, and counts as a restart."""
    monkeypatch.setattr("roverlink.runtime.bridge.link_exchange._SILENT_S", 0.0)
    with _rig(link_policy="refuse") as rig:
        rig.receive(_board(_DRIVE_ROWS, {2: 99}).write(1))
        rig.receive(_payload("drive_state"))
        assert rig.account.dropped["other_schema"] == 1
        rig.receive(_board(_DRIVE_ROWS).write(1))
        rig.receive(_payload("drive_state"))
        assert rig.account.published["drive_state"] == 1
        report = _report(rig, _DRIVE)
        assert (report.schema, report.restarts, report.senders) == (SAME, 1, 1)


def test_invented_sessions_are_answered_once_a_second_and_forgotten() -> None:
    """A stranger who invents a session in each datagram neither fills the memory nor the link to a board."""
    began = time.monotonic()
    with _rig() as rig:
        rig.receive(*[_board(_DRIVE_ROWS).write(1) for _ in range(300)], _board(_BASE_ROWS).write(1))
        assert (_report(rig, _DRIVE).senders, _report(rig, _BASE).senders) == (8, 1)
        assert rig.account.links_sent["hardware"] <= 2 * (time.monotonic() - began + 2)


# --- measurements -----------------------------------------------------------------------------------------------


def test_loss_and_round_trip_are_measured() -> None:
    """Datagrams that a board sent and that did not arrive, and the time of an answer, are in the report."""
    with _rig() as rig:
        board, asked = _board(_DRIVE_ROWS), link_message.read(_heard(rig))
        arrived_us = _now_us()
        board.count_sent(3)
        rig.receive(board.write(_now_us()))
        board.count_sent(10)
        rig.receive(*[_payload("drive_state")] * 6)
        board.note_heard(asked, arrived_us, 0)
        rig.receive(board.write(_now_us()))
        report = _report(rig, _DRIVE)
        assert (report.lost_in, report.loss_in) == (4, pytest.approx(4 / 11))
        assert report.statistics is not None
        assert report.statistics.round_trip_us is not None
        assert 0 <= report.statistics.round_trip_us < 500_000
        wall_us = time.time_ns() // 1000 - _now_us()
        assert report.clock_offset_us == pytest.approx(-wall_us, abs=500_000)


def test_no_two_link_messages_have_the_same_time() -> None:
    """An echo names a link message by its time, also on a computer whose clock has not moved."""
    board = _board(_DRIVE_ROWS)
    for time_us, sent in ((5, 0), (6, 1)):
        board.write(5)
        assert board.sent_before(time_us) == sent


@pytest.mark.slow
def test_lost_commands_are_counted_by_what_the_board_received() -> None:
    """The board tells how many datagrams came before the link message that it answers; the rest is lost."""
    with _rig() as rig:
        board = _board(_DRIVE_ROWS)
        board.note_heard(link_message.read(_heard(rig)), _now_us(), 0)
        rig.receive(board.write(_now_us()))
        _heard(rig)  # the answer to the new session
        for _ in range(5):
            rig.publish("drive_command")
        last = _heard(rig)
        assert last.sent == 7
        board.note_heard(link_message.read(last), _now_us(), 4)  # two link messages, and two of five commands
        rig.receive(board.write(_now_us()))
        report = _report(rig, _DRIVE)
        assert (report.lost_out, report.loss_out) == (3, pytest.approx(3 / 7))


def test_the_largest_link_message_is_as_large_as_the_compiler_says() -> None:
    """The size that the lint compares with `max_size` is that of a message with the largest values."""
    most = 2**32 - 1
    values = dict.fromkeys(("session", "sequence", "sent", "received", "echo_age_us"), most)
    link = {**values, "time_us": 2**64 - 1, "echo_us": 2**64 - 1, "numbers": [most] * 8, "hashes": [most] * 8}
    assert linked_registry().envelope(link=link).link.ByteSize() == largest_link_size()  # type: ignore[attr-defined]


def test_the_core_refuses_a_link_message_where_only_topics_count() -> None:
    """A program that only translates says that a link message has no topic."""
    with pytest.raises(DatagramError, match="a link message, which has no topic"):
        Translator(linked_registry()).receive(_board([1]).write(1))


# --- clients ----------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(("hashes", "schema", "rows"), [({}, SAME, ()), ({4: 7}, DIFFERS, ("mode",))])
def test_a_client_exchanges_link_messages_by_itself(hashes: dict[int, int], schema: str, rows: tuple[str, ...]) -> None:
    """The bridge and the client know each other's schemas and measure the link; the program sees payloads alone."""
    linked = linked_registry()
    assert linked.link is not None
    table = dataclasses.replace(linked, link=dataclasses.replace(linked.link, hashes={**_hashes(), **hashes}))
    with _rig() as rig, BlockingPeer.open("base", registry=table, port=rig.bridge.port, local_port=0) as peer:
        rig.live.change({"dst_a_port": peer.port})
        assert peer.link is not None
        while peer.link.statistics.round_trip_us is None:
            with pytest.raises(TimeoutError):
                peer.receive(timeout=0.1)
        assert peer.link.differing == rows
        report = _report(rig, _BASE)
        assert (report.schema, report.differing) == (schema, rows)
        assert peer.link.statistics.inbound.lost == 0
        assert peer.link.statistics.clock_offset_us == pytest.approx(0, abs=500_000)


def test_a_client_can_be_one_board() -> None:
    """Its link messages tell the rows of this board alone, and it cannot send those of another board."""
    linked = linked_registry()
    with (
        _rig() as rig,
        BlockingPeer.open("hardware", board="Drive", registry=linked, port=rig.bridge.port, local_port=0) as board,
    ):
        board.send(linked.by_name["drive_state"].payload_type())
        with pytest.raises(SetupError, match="Drive of hardware cannot send arm_state: Arm sends it"):
            board.send(linked.by_name["arm_state"].payload_type())
        wait_until(lambda: _report(rig, _DRIVE).schema == SAME, "the link message of the board")
        assert _report(rig, _ARM).schema == UNKNOWN
        wait_until(lambda: rig.account.published == {"drive_state": 1}, "the payload")


@pytest.mark.parametrize(("board", "expected"), [("Drve", "did you mean 'Drive'?"), ("Wheel", "known: Arm, Drive")])
def test_an_unknown_board_is_an_error(board: str, expected: str) -> None:
    """The error names the boards of the peer."""
    with pytest.raises(SetupError) as caught:
        BlockingPeer.open("hardware", board=board, registry=linked_registry())
    assert str(caught.value) == f"unknown board {board!r}; {expected}"


# --- addresses --------------------------------------------------------------------------------------------------


def _learning(**of_hardware: Any) -> Registry:
    """The registry with two boards whose addresses are learned."""
    boards = tuple(
        End(name, host="learn", host_parameter=f"{name}_host", port_parameter=f"{name}_port")
        for name in ("Arm", "Drive")
    )
    return of_peers(linked_registry(), hardware={"boards": boards, "port_parameter": "", **of_hardware})


def _states(rig: Rig) -> list[str]:
    """The states of the two boards' addresses."""
    return [rig.bridge.link_states()[board].state for board in (_ARM, _DRIVE)]


def test_a_link_message_teaches_the_address_of_its_board() -> None:
    """A board that only receives says by its link messages where it is; those of one board tell nothing of another."""
    with _rig(_learning()) as rig:
        rig.receive(_board(_DRIVE_ROWS).write(1))
        assert _states(rig) == ["not_learned", "ok"]
        assert rig.bridge.link_states()[_DRIVE].addresses == (f"127.0.0.1:{port_of(rig.board)}",)
        rig.receive(_board([1, *_DRIVE_ROWS]).write(1))  # one program for both boards
        assert _states(rig) == ["ok", "ok"]


def test_a_link_message_from_a_wrong_source_is_ignored(caplog: pytest.LogCaptureFixture) -> None:
    """It neither teaches an address nor refuses rows, and the log says why."""
    with _rig(_learning(sources=("127.0.0.2",)), source_policy="mapping", link_policy="refuse") as rig:
        rig.receive(_board(_DRIVE_ROWS, {2: 7}).write(1))
        assert "a link message with rows of other peers has come from an address of base" in caplog.text
        assert rig.account.dropped == {"wrong_source": 1}
        assert _states(rig) == ["not_learned", "not_learned"]
        assert _report(rig, _DRIVE).schema == UNKNOWN
        assert rig.account.other_schemas == {}


def test_nobody_on_the_network_tells_the_schemas_of_a_board_with_a_line() -> None:
    """A program that claims to be the whole peer is refused; the other board tells its own."""
    arm, drive = _learning().peers_by_name["hardware"].boards
    boards = (dataclasses.replace(arm, host="tcp:127.0.0.1:1"), drive)
    with _rig(of_peers(_learning(), hardware={"boards": boards}), link_policy="refuse") as rig:
        rig.receive(_board([1, *_DRIVE_ROWS], {1: 7, 2: 7}).write(1))
        assert rig.account.dropped == {"wrong_source": 1}
        assert set(_schemas(rig).values()) == {UNKNOWN}
        rig.receive(_board(_DRIVE_ROWS, {2: 7}).write(1))
        assert _schemas(rig) == {_ARM: UNKNOWN, _DRIVE: DIFFERS, _BASE: UNKNOWN}
