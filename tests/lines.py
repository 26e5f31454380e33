"""Serial cable of a test: a board at one end, and a device file for the program at the other one."""

from __future__ import annotations

import binascii
import contextlib
import os
import pty
import select
import tty
from collections.abc import Iterator
from pathlib import Path

from cobs import cobs
from polling import PATIENCE_S


def framed(datagram: bytes) -> bytes:
    """The frame of a datagram, made by others: CRC-16/CCITT-FALSE by zlib's neighbour in Python, COBS by a package."""
    return bytes(cobs.encode(datagram + binascii.crc_hqx(datagram, 0xFFFF).to_bytes(2, "big"))) + b"\0"


class Cable:
    """Cable that is plugged in until it is pulled; ``path`` is the device file."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.board, program = pty.openpty()
        tty.setraw(program)
        # As long as the test has both ends open, a pseudo-terminal does not hang up.
        self._ends = [self.board, program]
        self._bytes = b""
        path.symlink_to(os.ttyname(program))

    def write(self, data: bytes) -> None:
        """Send bytes as the board does."""
        while data:
            data = data[os.write(self.board, data) :]

    def send(self, *datagrams: bytes) -> None:
        """Send datagrams as the board does."""
        self.write(b"".join(map(framed, datagrams)))

    def receive(self) -> bytes:
        """The next datagram that the program has sent to the board."""
        while b"\0" not in self._bytes.lstrip(b"\0"):
            assert select.select([self.board], [], [], PATIENCE_S)[0], "nothing comes over the cable"
            self._bytes += os.read(self.board, 4096)
        frame, _, self._bytes = self._bytes.lstrip(b"\0").partition(b"\0")
        decoded = bytes(cobs.decode(frame))
        assert framed(decoded[:-2]) == frame + b"\0"
        return decoded[:-2]

    def read(self, most: int) -> bytes:
        """Bytes that the program has sent, at most so many; nothing if there are none."""
        return os.read(self.board, most) if select.select([self.board], [], [], 0)[0] else b""

    def pull(self) -> None:
        """Pull the cable: the device file disappears. May be repeated."""
        self.path.unlink(missing_ok=True)
        while self._ends:
            os.close(self._ends.pop())


@contextlib.contextmanager
def cable(path: Path) -> Iterator[Cable]:
    """A cable, which is pulled at the end."""
    plugged = Cable(path)
    yield plugged
    plugged.pull()
