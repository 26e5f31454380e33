"""A bridge whose table has the link message compares schemas with its peers, and measures the link."""

from __future__ import annotations

import dataclasses
import logging
import socket
import threading
import time
from collections.abc import Mapping, Sequence
from typing import Any

import pytest
from linked import linked_registry
from polling import wait_until
from tables import of_peers

from roverlink.runtime import Bridge, Qos, Registry, SetupError
from roverlink.runtime.bridge.link_exchange import DIFFERS, SAME, UNKNOWN, EndReport
from roverlink.runtime.client import BlockingPeer
from roverlink.runtime.core import link_message
from roverlink.runtime.core.link_message import LinkWriter
from roverlink.runtime.core.registry import End, EndName
from roverlink.runtime.core.translator import Translator
from roverlink.runtime.middleware.memory import Graph, MemoryMiddleware
from roverlink.runtime.ros_arguments import parameters

_ARM, _DRIVE, _BASE = EndName("hardware", "Arm"), EndName("hardware", "Drive"), EndName("base")
_ARM_ROWS, _DRIVE_ROWS, _BASE_ROWS = [1], [2, 3], [4, 5, 1]


@pytest.fixture(scope="module")
def registry() -> Registry:
    """The registry of a small rover with the link message."""
    return linked_registry()


class _Rig:
    """A bridge with its peers' sockets."""

    def __init__(self, registry: Registry, **given: Any) -> None:
        self.registry = registry
        self.sockets = {peer.name: _socket() for peer in registry.peers}
        ends = [peer for peer in registry.peers if not peer.boards]
        ports = {peer.port_parameter: self.sockets[peer.name].getsockname()[1] for peer in ends}
        self.values = {"listen_port": 0, "listen_address": "127.0.0.1", **ports, **given}
        self.graph = Graph()
        self.log: list[str] = []
        logger = logging.Logger("bridge")
        logger.addHandler(_Handler(self.log))
        self.bridge = Bridge(
            registry, parameters.read(registry, self.values), MemoryMiddleware(self.graph), lambda t: f"/{t}", logger
        )
        self.nodes = MemoryMiddleware(self.graph)
        self._out = _socket()

    def __enter__(self) -> _Rig:
        self.bridge.__enter__()
        self._thread = threading.Thread(target=self.bridge.run)
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.bridge.stop()
        self._thread.join()
        self.bridge.__exit__(None, None, None)
        for sock in (*self.sockets.values(), self._out):
            sock.close()
        assert self.bridge.account.discrepancies() == []

    def send(self, *datagrams: bytes) -> None:
        """Send datagrams of a peer, and wait until the bridge has handled them."""
        before = self.bridge.account.received
        for datagram in datagrams:
            self._out.sendto(datagram, ("127.0.0.1", self.bridge.port))
        wait_until(lambda: self.bridge.account.received >= before + len(datagrams), "the datagrams")
        wait_until(lambda: not self.bridge.account.discrepancies(), "the counts")

    def report(self, end: EndName) -> EndReport:
        """Return what the bridge knows about an end."""
        (report,) = [report for report in self.bridge.link_reports() if report.end == end]
        return report

    def heard(self, peer: str) -> Any:
        """Return the next link message that a peer gets."""
        while True:
            envelope = self.registry.envelope.FromString(self.sockets[peer].recv(2000))
            if envelope.WhichOneof("payload") == "link":
                return envelope.link  # type: ignore[attr-defined]

    def change(self, **changes: Any) -> None:
        """Set parameters of the running bridge."""
        self.bridge.change(parameters.read(self.registry, {**self.values, **changes}))


class _Handler(logging.Handler):
    def __init__(self, lines: list[str]) -> None:
        super().__init__()
        self._lines = lines

    def emit(self, record: logging.LogRecord) -> None:
        """Keep the message."""
        self._lines.append(record.getMessage())


def _socket() -> socket.socket:
    sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sock.bind(("127.0.0.1", 0))
    sock.settimeout(5)
    return sock


def _board(registry: Registry, numbers: Sequence[int], other: Mapping[int, int] | None = None) -> LinkWriter:
    """Return a program that speaks some rows, with another hash of those in ``other``."""
    assert registry.link is not None
    hashes = {number: registry.link.hashes.get(number, 0) for number in numbers} | dict(other or {})
    return LinkWriter(registry.envelope, link_message.new_session(), hashes)


def _now_us() -> int:
    return time.monotonic_ns() // 1000


def _payload(registry: Registry, name: str) -> bytes:
    return registry.envelope(**{name: {}}).SerializeToString()


def test_the_bridge_says_its_rows_at_once_to_each_peer(registry: Registry) -> None:
    """Each peer gets the hashes of its rows and of those forwarded to it, its own first, and then once a second."""
    assert registry.link is not None
    with _Rig(registry) as rig:
        first, base = rig.heard("hardware"), rig.heard("base")
        second = rig.heard("hardware")
    assert dict(zip(first.numbers, first.hashes)) == {n: registry.link.hashes[n] for n in (1, 2, 3)}
    assert list(base.numbers) == [4, 5, 1]
    assert first.session == second.session == base.session != 0
    assert (first.sequence, second.sequence, base.sequence) == (1, 2, 1)
    assert (first.sent, second.sent) == (0, 1)
    assert second.time_us - first.time_us == pytest.approx(1_000_000, abs=500_000)


def test_the_sender_is_told_by_its_rows(registry: Registry) -> None:
    """A board, the basestation, or one program with all rows of a peer: each is found by the rows that it says."""
    with _Rig(registry) as rig:
        assert {(report.end, report.schema) for report in rig.bridge.link_reports()} == {
            (end, UNKNOWN) for end in (_ARM, _DRIVE, _BASE)
        }
        rig.send(_board(registry, _DRIVE_ROWS).write(1), _board(registry, _BASE_ROWS).write(1))
        assert {(report.end, report.schema) for report in rig.bridge.link_reports()} == {
            (_ARM, UNKNOWN),
            (_DRIVE, SAME),
            (_BASE, SAME),
        }
        rig.send(_board(registry, [1, 2, 3]).write(1))
        assert rig.report(EndName("hardware")).schema == SAME
        assert len(rig.bridge.link_reports()) == 2


def test_a_sender_without_a_row_of_the_table_is_told(registry: Registry) -> None:
    """A link message from which nobody can tell who sent it is logged once, and forgotten."""
    with _Rig(registry) as rig:
        stranger = _board(registry, [77, 78])
        rig.send(stranger.write(1), stranger.write(2), _board(registry, []).write(3))
        assert all(report.schema == UNKNOWN for report in rig.bridge.link_reports())
    assert next(line for line in rig.log if "its sender is unknown" in line).endswith("its sender is unknown")


def test_a_board_with_another_schema_is_named_once(registry: Registry) -> None:
    """The rows that differ are named, with the board, once for each start of the board; the messages are passed on."""
    with _Rig(registry) as rig:
        board = _board(registry, _DRIVE_ROWS, {2: 99})
        rig.send(board.write(1), board.write(2), _payload(registry, "drive_state"))
        assert rig.report(_DRIVE).schema == DIFFERS
        assert rig.report(_DRIVE).differing == ("drive_state",)
        assert rig.report(_ARM).schema == UNKNOWN
        assert rig.bridge.account.published["drive_state"] == 1
        rig.send(_board(registry, _DRIVE_ROWS, {2: 99}).write(1))
    assert [line for line in rig.log if "schema" in line] == [
        "Drive of hardware has another schema of drive_state (2): messages are passed on; values may be misread "
        f"(parameter link_policy){more}"
        for more in ("", " (and 1 more like it)")
    ]


def test_rows_that_differ_are_refused_in_both_directions_if_the_policy_says_so(registry: Registry) -> None:
    """With `refuse`, datagrams of such a row are dropped with a reason, and its commands are not sent."""
    with _Rig(registry, link_policy="refuse") as rig:
        command = registry.by_name["drive_command"]
        publisher = rig.nodes.publisher("/drive_command", command.message_type, Qos())
        rig.send(_board(registry, _DRIVE_ROWS, {2: 99, 3: 98}).write(1))
        rig.send(_payload(registry, "drive_state"), _payload(registry, "arm_state"))
        publisher.publish([command.to_cdr(command.payload_type())])
        wait_until(lambda: rig.bridge.account.refused["drive_command"] == 1, "the refused command")
        assert rig.bridge.account.dropped["other_schema"] == 1
        assert rig.bridge.account.dropped_of_row["drive_state", "other_schema"] == 1
        assert rig.bridge.account.published == {"arm_state": 1}
        assert rig.bridge.account.sent.total() == 0

        rig.change(link_policy="warn")
        rig.send(_payload(registry, "drive_state"))
        publisher.publish([command.to_cdr(command.payload_type())])
        wait_until(lambda: rig.bridge.account.sent["drive_command"] == 1, "the sent command")
        assert rig.bridge.account.published["drive_state"] == 1


def test_a_row_that_differs_at_the_receiver_of_forwarded_datagrams_is_only_not_forwarded(registry: Registry) -> None:
    """The topic still gets a row that the basestation would misread, but the basestation does not."""
    with _Rig(registry, link_policy="refuse") as rig:
        rig.send(_board(registry, _BASE_ROWS, {1: 99}).write(1))
        rig.send(_payload(registry, "arm_state"))
        assert rig.report(_BASE).differing == ("arm_state",)
        assert rig.bridge.account.published["arm_state"] == 1
        wait_until(lambda: rig.bridge.account.unforwarded["base"] == 1, "the datagram")
        assert rig.bridge.account.forwarded["base"] == 0


def test_a_board_that_was_flashed_again_is_trusted_again(registry: Registry, monkeypatch: pytest.MonkeyPatch) -> None:
    """A new session of the same board takes the place of the silent old one, and counts as a restart."""
    monkeypatch.setattr("roverlink.runtime.bridge.link_exchange._SILENT_S", 0.0)
    with _Rig(registry, link_policy="refuse") as rig:
        rig.send(_board(registry, _DRIVE_ROWS, {2: 99}).write(1))
        rig.send(_payload(registry, "drive_state"))
        assert rig.bridge.account.dropped["other_schema"] == 1
        rig.send(_board(registry, _DRIVE_ROWS).write(1))
        rig.send(_payload(registry, "drive_state"))
        assert rig.bridge.account.published["drive_state"] == 1
        assert (rig.report(_DRIVE).schema, rig.report(_DRIVE).restarts, rig.report(_DRIVE).senders) == (SAME, 1, 1)


def test_two_laptops_are_two_senders(registry: Registry) -> None:
    """Two programs that speak for one peer at the same time are no restart, and their loss cannot be told."""
    with _Rig(registry) as rig:
        first, second = _board(registry, _BASE_ROWS), _board(registry, _BASE_ROWS, {5: 1})
        rig.send(first.write(1), second.write(1), first.write(2), second.write(2))
        report = rig.report(_BASE)
        assert (report.senders, report.restarts, report.lost_in, report.schema) == (2, 0, None, DIFFERS)


def test_a_new_board_is_asked_at_once(registry: Registry) -> None:
    """When a new session appears, the bridge tells its rows without waiting for the next second."""
    with _Rig(registry) as rig:
        rig.heard("hardware")
        before = time.monotonic()
        rig.send(_board(registry, _DRIVE_ROWS).write(123))
        answer = rig.heard("hardware")
        assert time.monotonic() - before < 0.7
        assert answer.echo_us == 123
        assert answer.received == 0


def test_loss_and_round_trip_are_measured(registry: Registry) -> None:
    """Datagrams that a board sent and that did not arrive, and the time of an answer, are in the report."""
    with _Rig(registry) as rig:
        board, asked = _board(registry, _DRIVE_ROWS), rig.heard("hardware")
        arrived_us = _now_us()
        board.count_sent(3)
        rig.send(board.write(_now_us()))
        board.count_sent(10)
        rig.send(*[_payload(registry, "drive_state")] * 6)
        board.note_heard(_read(asked), arrived_us, 0)
        time.sleep(0.02)
        rig.send(board.write(_now_us()))
        report = rig.report(_DRIVE)
        assert (report.lost_in, report.loss_in) == (4, pytest.approx(4 / 11))
        assert report.statistics is not None
        assert report.statistics.round_trip_us is not None
        assert 0 <= report.statistics.round_trip_us < 500_000
        assert report.clock_offset_us is not None
        wall_us = time.time_ns() // 1000 - _now_us()
        assert report.clock_offset_us == pytest.approx(-wall_us, abs=500_000)


def test_the_loss_is_that_of_the_end_that_the_sender_turns_out_to_be(registry: Registry) -> None:
    """A basestation whose first link message lists only forwarded rows is taken for their board until the next one."""
    assert registry.link is not None
    with _Rig(registry) as rig:
        rig.send(*[_payload(registry, "arm_state")] * 3)
        session = link_message.new_session()
        begun, base = (
            LinkWriter(registry.envelope, session, {number: registry.link.hashes[number] for number in numbers})
            for numbers in ([1], [4, 5])
        )
        rig.send(begun.write(1))
        assert rig.report(_ARM).senders == 1
        base.write(1)
        rig.send(base.write(2), base.write(3))
        assert (rig.report(_BASE).lost_in, rig.report(_BASE).loss_in) == (0, 0.0)


def test_lost_commands_are_counted_by_what_the_board_received(registry: Registry) -> None:
    """The board tells how many datagrams came before the link message that it answers; the rest is lost."""
    with _Rig(registry) as rig:
        command = registry.by_name["drive_command"]
        publisher = rig.nodes.publisher("/drive_command", command.message_type, Qos())
        board = _board(registry, _DRIVE_ROWS)
        board.note_heard(_read(rig.heard("hardware")), _now_us(), 0)
        rig.send(board.write(_now_us()))
        rig.heard("hardware")  # the answer to the new session
        publisher.publish([command.to_cdr(command.payload_type())] * 5)
        wait_until(lambda: rig.bridge.account.sent["drive_command"] == 5, "five commands")
        last = rig.heard("hardware")
        assert last.sent == 7
        board.note_heard(_read(last), _now_us(), 4)  # two link messages, and two of five commands
        rig.send(board.write(_now_us()))
        assert (rig.report(_DRIVE).lost_out, rig.report(_DRIVE).loss_out) == (3, pytest.approx(3 / 7))


def _read(payload: Any) -> link_message.LinkMessage:
    return link_message.read(payload)


def test_many_rows_are_said_in_turn(registry: Registry) -> None:
    """A link message has at most eight rows; the next ones have the others, and the bridge takes them together."""
    writer = LinkWriter(registry.envelope, 1, {number: number for number in range(1, 21)})
    assert writer.turns == 3
    said = [list(registry.envelope.FromString(writer.write(t)).link.numbers) for t in range(4)]  # type: ignore[attr-defined]
    assert said == [[*range(1, 9)], [*range(9, 17)], [*range(17, 21)], [*range(1, 9)]]


def test_the_largest_link_message_is_as_large_as_the_compiler_says(registry: Registry) -> None:
    """The size that the lint compares with `max_size` is that of a message with the largest values."""
    from roverlink.generator.ir import largest_link_size

    most = 2**32 - 1
    values = dict.fromkeys(("session", "sequence", "sent", "received", "echo_age_us"), most)
    link = {**values, "time_us": 2**64 - 1, "echo_us": 2**64 - 1, "numbers": [most] * 8, "hashes": [most] * 8}
    assert len(registry.envelope(link=link).link.SerializeToString()) == largest_link_size()  # type: ignore[attr-defined]


def test_a_table_without_the_link_message_has_no_such_parameter() -> None:
    """`link_policy` exists only where there is a link message, with the table's default."""
    from generated.registry import REGISTRY

    assert "link_policy" not in parameters.declarations(REGISTRY)
    assert REGISTRY.link is None
    linked = linked_registry()
    assert linked.link is not None
    refusing = dataclasses.replace(linked, link=dataclasses.replace(linked.link, on_mismatch="refuse"))
    assert parameters.read(refusing, {}).link_policy == "refuse"


def test_the_core_refuses_a_link_message_where_only_topics_count(registry: Registry) -> None:
    """A program that only translates says that a link message has no topic."""
    with pytest.raises(Exception, match="a link message, which has no topic"):
        Translator(registry).receive(_board(registry, [1]).write(1))


def test_a_client_exchanges_link_messages_by_itself(registry: Registry) -> None:
    """The bridge and the client know each other's schemas and measure the link; the program sees payloads alone."""
    assert registry.link is not None
    other = dataclasses.replace(
        registry, link=dataclasses.replace(registry.link, hashes={**registry.link.hashes, 4: 7})
    )
    for table, schema, rows in ((registry, SAME, ()), (other, DIFFERS, ("mode",))):
        with (
            _Rig(registry) as rig,
            BlockingPeer.open("base", registry=table, port=rig.bridge.port, local_port=0) as peer,
        ):
            rig.change(dst_a_port=peer.port)
            assert peer.link is not None
            while peer.link.statistics.round_trip_us is None:
                with pytest.raises(TimeoutError):
                    peer.receive(timeout=0.1)
            assert peer.link.differing == rows
            report = rig.report(_BASE)
            assert (report.schema, report.differing) == (schema, rows)
            assert peer.link.statistics.inbound.lost == 0
            assert peer.link.statistics.clock_offset_us == pytest.approx(0, abs=500_000)


def test_a_client_can_be_one_board(registry: Registry) -> None:
    """Its link messages tell the rows of this board alone, and it cannot send those of another board."""
    other = registry.by_name["arm_state"].payload_type()
    with (
        _Rig(registry) as rig,
        BlockingPeer.open("hardware", board="Drive", registry=registry, port=rig.bridge.port, local_port=0) as board,
    ):
        board.send(registry.by_name["drive_state"].payload_type())
        with pytest.raises(SetupError, match="Drive of hardware cannot send arm_state: Arm sends it"):
            board.send(other)
        wait_until(lambda: rig.report(_DRIVE).schema == SAME, "the link message of the board")
        assert rig.report(_ARM).schema == UNKNOWN
        wait_until(lambda: rig.bridge.account.published == {"drive_state": 1}, "the payload")


@pytest.mark.parametrize(
    ("peer", "board", "expected"),
    [
        ("hardware", "Drve", "unknown board 'Drve'; did you mean 'Drive'?"),
        ("hardware", "Wheel", "unknown board 'Wheel'; known: Arm, Drive"),
    ],
)
def test_an_unknown_board_is_an_error(registry: Registry, peer: str, board: str, expected: str) -> None:
    """The error names the boards of the peer."""
    with pytest.raises(SetupError) as caught:
        BlockingPeer.open(peer, board=board, registry=registry)
    assert str(caught.value) == expected


# --- addresses --------------------------------------------------------------------------------------------------


def _learning(registry: Registry, **of_hardware: Any) -> Registry:
    """Return the registry with two boards whose addresses are learned."""
    boards = tuple(
        End(name, host="learn", host_parameter=f"{name}_host", port_parameter=f"{name}_port")
        for name in ("Arm", "Drive")
    )
    return of_peers(registry, hardware={"boards": boards, "port_parameter": "", **of_hardware})


def test_a_link_message_teaches_the_address_of_its_board(registry: Registry) -> None:
    """A board that only receives says by its link messages where it is; those of one board tell nothing of another."""
    with _Rig(_learning(registry)) as rig:
        rig.send(_board(registry, _DRIVE_ROWS).write(_now_us()))
        wait_until(lambda: rig.bridge.link_states()[_DRIVE].state == "ok", "the address of the one board")
        assert rig.bridge.link_states()[_ARM].state == "not_learned"
        rig.send(_board(registry, [*_ARM_ROWS, *_DRIVE_ROWS]).write(_now_us()))  # one program for both boards
        wait_until(lambda: rig.bridge.link_states()[_ARM].state == "ok", "the address of the other board")


def test_a_link_message_that_only_repeats_rows_of_others_teaches_nothing(registry: Registry) -> None:
    """The basestation tells rows that are forwarded to it; these are not the board's own words."""
    with _Rig(_learning(registry)) as rig:
        session = link_message.new_session()
        for numbers in ([4, 1], [1]):
            writer = LinkWriter(registry.envelope, session, dict.fromkeys(numbers, 0))
            rig.send(writer.write(_now_us()))
        rig.send(_board(registry, _DRIVE_ROWS).write(_now_us()))
        wait_until(lambda: rig.bridge.link_states()[_DRIVE].state == "ok", "the batch after the two")
        assert rig.bridge.link_states()[_ARM].state == "not_learned"


def test_a_link_message_from_a_wrong_source_is_ignored(registry: Registry) -> None:
    """It neither teaches an address nor refuses rows, and the log says why."""
    with _Rig(_learning(registry, sources=("127.0.0.2",)), source_policy="mapping", link_policy="refuse") as rig:
        rig.send(_board(registry, _DRIVE_ROWS, {2: 7}).write(_now_us()))
        text = "a link message of Drive of hardware has come from an address that is not in its `sources`"
        wait_until(lambda: any(text in line for line in rig.log), "the warning")
        assert rig.bridge.link_states()[_DRIVE].state == "not_learned"
        assert rig.report(_DRIVE).schema == UNKNOWN
        assert rig.bridge.account.other_schemas == {}
