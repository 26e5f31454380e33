"""Signatures of one program: the keys and the clock of each of its links, and the timestamps that it stores.

The timestamps are stored beside the key file, in ``FILE.NAME.timestamps`` for the program NAME. These rules hold at
the start of a program:

- A key with a stored timestamp goes on one second after it, because it is stored only once a second. So no recording is
  accepted, whatever the computer's clock says, and a peer is refused for at most a second.
- A key without a stored timestamp (the first start, or the file is lost or damaged) accepts nothing that is older than
  the key, or more than a minute older than the computer's clock. This is the rule of MAVLink 2 for new streams.
- The own datagrams go on after the latest of these timestamps of their link.

A link whose clock is ahead of the computer's is reported once: it stays so, also after a restart.
"""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from datetime import timedelta
from pathlib import Path

from roverlink.runtime.core.errors import SetupError, nearest
from roverlink.runtime.core.periodic_thread import PeriodicThread
from roverlink.runtime.core.registry import EndName
from roverlink.runtime.core.signing import NOTABLY_AHEAD, TICKS_PER_SECOND, Signer, SigningClock, Verifier, ticks
from roverlink.runtime.keys.key_file import BRIDGE, FileKey, read_keys
from roverlink.runtime.keys.stored_timestamps import read_timestamps, write_timestamps

_INTERVAL_S = 1.0
_OLDEST_UNKNOWN = 60 * TICKS_PER_SECOND


class SignedLinks:
    """Signatures of a program. A context manager: inside the block, a thread stores the timestamps once a second."""

    def __init__(
        self,
        number: int,
        files: Sequence[Path],
        logger: logging.Logger,
        own: str = BRIDGE,
        wall: Callable[[], int] = time.time_ns,
        steady: Callable[[], int] = time.monotonic_ns,
        bridge: str = BRIDGE,
    ) -> None:
        """Read the key files and the stored timestamps.

        ``number`` is the field number of the envelope's signature. ``own`` is the name of this program in the key
        files: that of a peer or board, or ``ros`` for the bridge. ``wall`` and ``steady`` are clocks in nanoseconds.
        ``bridge`` is what this program calls the bridge. Raises `SetupError` if a file cannot be used.
        """
        self._logger, self._own, self._bridge = logger, own, bridge
        self._files = {path.with_name(f"{path.name}.{own}.timestamps"): read_keys(path) for path in files}
        self._keys = [key for keys in self._files.values() for key in keys]
        _check_ids(files, self._files.values())
        self._stored = {path: self._read(path) for path in self._files}
        self._starts = {
            file_key.key.id: self._start(file_key, self._stored[path].get(file_key.key.id), ticks(wall()))
            for path, keys in self._files.items()
            for file_key in keys
        }
        self.clocks: Mapping[str, SigningClock] = {
            end: self._clock([file_key for file_key in self._keys if file_key.end == end], wall, steady)
            for end in dict.fromkeys(file_key.end for file_key in self._keys)
        }
        """Clock of each link, by the peer or board at the end of it that is not the bridge."""
        self.verifier = Verifier(
            number,
            [
                (
                    replace(file_key.key, sender=self._called(file_key.key.sender)),
                    self._starts[file_key.key.id],
                    self.clocks[file_key.end],
                )
                for file_key in self._keys
                if file_key.receiver == own
            ],
        )
        self._sent = [file_key for file_key in self._keys if file_key.key.sender == own]
        self._signers = {
            self._called(file_key.receiver): Signer(number, file_key.key, self.clocks[file_key.end])
            for file_key in self._sent
            if file_key.send_with
        }
        self._warned_ahead: set[str] = set()
        self._warn_of_clocks()
        self._failing = False
        self._thread = PeriodicThread("signing-timestamps", _INTERVAL_S, self._keep, logger)
        for path, timestamps in self._stored.items():
            try:
                write_timestamps(path, timestamps)  # what cannot be stored is better known now
            except OSError as error:
                cure = "put the key file into a folder in which this user can write"
                raise SetupError(f"{path}: cannot write the file: {error.strerror}; {cure}") from error

    def signer(self, ends: Iterable[str]) -> Signer | None:
        """Return the signer of datagrams to the first of the given peers and boards that has a key, or None."""
        return next((self._signers[end] for end in ends if end in self._signers), None)

    def hears(self, ends: Iterable[str]) -> bool:
        """Return true if one of the given peers and boards has a key to sign datagrams for this program."""
        senders = {self._called(file_key.key.sender) for file_key in self._keys if file_key.receiver == self._own}
        return not senders.isdisjoint(ends)

    def check_ends(self, known: Iterable[str]) -> None:
        """Raise `SetupError` if a key is of a peer or board that is not among the known ones."""
        ends = [*known]
        for file_key in self._keys:
            if file_key.end not in ends:
                what = f"the key {file_key.key.id} is of {file_key.end!r}, but the table has no such peer or board"
                raise SetupError(f"{what}; {nearest(file_key.end, ends)}")

    def __enter__(self) -> SignedLinks:
        self._thread.__enter__()
        return self

    def __exit__(self, *_: object) -> None:
        self._thread.__exit__()
        self._keep()  # the last timestamps

    def _called(self, name: str) -> str:
        """Return what this program calls a sender or receiver in the key files."""
        return self._bridge if name == BRIDGE else name

    def _keep(self) -> None:
        self._store_all()
        self._warn_of_clocks()

    def _warn_of_clocks(self) -> None:
        """Log the links whose clock is ahead of the computer's, each once."""
        for end, clock in self.clocks.items():
            ahead = clock.ahead(clock.last)
            if ahead > NOTABLY_AHEAD and end not in self._warned_ahead:
                self._warned_ahead.add(end)
                self._logger.warning(
                    "the timestamps of the link with %r are %s ahead of this computer's clock, and stay so: the clock "
                    "of one of its ends is or was wrong; if that cannot be, somebody else has its keys: make new ones",
                    end,
                    timedelta(seconds=ahead // TICKS_PER_SECOND),
                )

    def _clock(self, keys: Sequence[FileKey], wall: Callable[[], int], steady: Callable[[], int]) -> SigningClock:
        """Return the clock of the link that has these keys."""
        earliest = max(self._starts[file_key.key.id] for file_key in keys)
        return SigningClock(earliest, wall, steady, max(file_key.made for file_key in keys))

    def _store_all(self) -> None:
        """Store the timestamps; log the first failure, and go on: a full disk must not stop the rover's commands."""
        failure = ""
        for path in self._files:
            try:
                self._store(path)
            except OSError as error:
                failure = f"{path}: cannot store the timestamps of the keys: {error.strerror}"
        if failure and not self._failing:
            self._logger.warning("%s; after a restart, recordings since now may be accepted", failure)
        self._failing = bool(failure)

    def _store(self, path: Path) -> None:
        """Store what has changed since the last call. A key that was not used keeps its timestamp.

        Otherwise each restart would add its second, and many restarts would refuse a peer without a clock.
        """
        now = {
            **self.verifier.lasts(),
            **{file_key.key.id: self.clocks[file_key.end].last for file_key in self._sent},
        }
        used = {id: last for id, last in now.items() if last > self._starts[id]}
        of_file = {file_key.key.id: used[file_key.key.id] for file_key in self._files[path] if file_key.key.id in used}
        timestamps = {**self._stored[path], **of_file}
        if timestamps != self._stored[path]:
            write_timestamps(path, timestamps)
            self._stored[path] = timestamps

    def _read(self, path: Path) -> dict[int, int]:
        """Return the stored timestamps; log a damaged file and return none."""
        stored = read_timestamps(path)
        if stored is None:
            self._logger.warning(
                "%s: the file is damaged; signed datagrams are refused if they are more than a minute older than this "
                "computer's clock",
                path,
            )
        return stored or {}

    @staticmethod
    def _start(file_key: FileKey, stored: int | None, now: int) -> int:
        """Return the timestamp after which a key begins."""
        return max(file_key.made, now - _OLDEST_UNKNOWN) if stored is None else stored + TICKS_PER_SECOND


def owner_of(end: EndName, files: Sequence[Path]) -> str:
    """Return whose keys a program of the peer or board ``end`` uses: a board without own keys uses those of its peer.

    Raises `SetupError` if a file cannot be used.
    """
    owners = {file_key.end for path in files for file_key in read_keys(path)}
    return end.board if end.board in owners else end.peer


def _check_ids(files: Sequence[Path], keys: Iterable[Sequence[FileKey]]) -> None:
    """Raise `SetupError` if two key files have a key with the same id: a datagram says only the id."""
    owners: dict[int, Path] = {}
    for path, of_file in zip(files, keys):
        for file_key in of_file:
            other = owners.setdefault(file_key.key.id, path)
            if other != path:
                cure = f"make one of them again in the folder of the other: roverlink link keygen {file_key.end}"
                raise SetupError(f"{other} and {path} both have a key {file_key.key.id}; {cure}")
