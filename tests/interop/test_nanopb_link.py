"""A board with nanopb and the generated roverlink_link.h tells its rows, and answers the bridge's link messages."""

from __future__ import annotations

import struct
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import IO, cast

import pytest
from linked import PROTO, TABLE, linked_registry, write_project
from nanopb_board import compiled
from polling import PATIENCE_S

from roverlink.runtime.core.link_message import LinkMessage, LinkWriter, read
from roverlink.runtime.core.link_statistics import LinkStatistics

_MANY = 12  # rows of the board beside its two own: more than one link message holds


class _Board:
    """The compiled program, as a child process."""

    def __init__(self, program: Path) -> None:
        self._child = subprocess.Popen([program], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self._in, self._out = cast(IO[bytes], self._child.stdin), cast(IO[bytes], self._child.stdout)

    def send(self, now_us: int) -> list[bytes]:
        """Return the envelopes that the board sends."""
        self._write(b"s", now_us)
        found = []
        while length := struct.unpack("<H", self._out.read(2))[0]:
            found.append(self._out.read(length))
        return found

    def lose(self, now_us: int) -> None:
        """Let the board send a datagram that nobody gets."""
        self._write(b"d", now_us)

    def take(self, now_us: int, envelope: bytes) -> bool:
        """Give the board an envelope with a link message; return what the board's function returned."""
        self._write(b"t", now_us, struct.pack("<H", len(envelope)) + envelope)
        return self._out.read(1) == b"\1"

    def _write(self, command: bytes, now_us: int, more: bytes = b"") -> None:
        self._in.write(command + struct.pack("<Q", now_us) + more)
        self._in.flush()

    def close(self) -> None:
        """End the program."""
        self._in.close()
        assert self._child.wait(PATIENCE_S) == 0
        self._out.close()


def _compiled(folder: Path, table: str = TABLE, proto: str = PROTO) -> Path:
    """Return the program for a project that has the target nanopb."""
    table = table.replace("messages:\n", "targets: [python, nanopb]\nmessages:\n")
    project = write_project(folder / "project", table, proto)
    names = ["linked/envelope.proto", "linked/link.proto", "linked/messages.proto"]
    return compiled(folder, project / "proto", project / "linked_rover" / "nanopb", names, "nanopb_link.c")


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The board's program."""
    return _compiled(tmp_path_factory.mktemp("linked"))


@pytest.fixture
def board(program: Path) -> Iterator[_Board]:
    """The running board."""
    board = _Board(program)
    yield board
    board.close()


def _read(envelope: bytes) -> LinkMessage:
    return read(linked_registry().envelope.FromString(envelope).link)  # type: ignore[attr-defined]


@pytest.mark.slow
def test_a_board_tells_the_hashes_of_its_rows(board: _Board) -> None:
    """The first message has the session, the rows of the board, and no echo."""
    link = linked_registry().link
    assert link is not None
    (first,) = map(_read, board.send(1000))
    assert first == LinkMessage(4711, 1, 0, 0, 1000, 0, 0, {2: link.hashes[2], 3: link.hashes[3]})


def test_loss_round_trip_and_offset_of_a_board_are_measured(board: _Board) -> None:
    """The board's clock is 5 s ahead, a way takes 2 ms, and two of its three datagrams are lost."""
    writer, statistics = LinkWriter(linked_registry().envelope, 99, {1: 1}), LinkStatistics()
    ahead_us, way_us, received = 5_000_000, 2_000, 0
    for turn in range(3):
        now_us = 10_000_000 + turn * 1_000_000
        assert board.take(now_us + way_us + ahead_us, writer.write(now_us)) == (turn == 0)
        answered_us = now_us + way_us + 700
        for envelope in board.send(answered_us + ahead_us):
            message = _read(envelope)
            assert (message.echo_us, message.echo_age_us, message.received) == (now_us, 700, turn)
            statistics.take(message, answered_us + way_us, received, writer.sent_before(message.echo_us))
            received += 1
        for _ in range(3 if turn == 0 else 0):
            board.lose(now_us)
        received += turn == 0
    assert (statistics.inbound.lost, statistics.outbound.lost) == (2, 0)
    assert (statistics.round_trip_us, statistics.clock_offset_us) == (2 * way_us, ahead_us)
    others = (LinkWriter(linked_registry().envelope, session, {1: 1}).write(1) for session in (97, 98))
    assert [board.take(20_000_000, other) for other in others] == [True, False]  # at most one answer in a second


@pytest.mark.slow
def test_a_board_with_many_rows_tells_them_in_several_messages(tmp_path: Path) -> None:
    """A message has room for eight rows; the board sends as many as it needs."""
    numbers = range(30, 30 + _MANY)
    row = "  - {{number: {0}, name: d{0}, proto: linked.Drive{0}, topic: d{0}, direction: hardware_to_ros}}\n"
    table = TABLE + "".join(map(row.format, numbers))
    proto = PROTO + "".join(f"message Drive{number} {{ float x = 1; }}\n" for number in numbers)
    board = _Board(_compiled(tmp_path, table, proto))
    for start in (1, 3):
        messages = list(map(_read, board.send(1000)))
        assert [message.sequence for message in messages] == [start, start + 1]
        assert [list(message.hashes) for message in messages] == [[2, 3, *range(30, 36)], [*range(36, 42)]]
    board.close()
