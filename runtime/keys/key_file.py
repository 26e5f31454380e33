"""Key file: the keys of a link between the bridge and a peer or board. Both ends have a copy of it.

Each key is for one direction, because only one sender may sign with a key. During a rotation there are several keys for
a direction: the receiver accepts all of them, and the sender signs with the one that is marked ``send_with``::

    [key 1]
    from = basestation
    to = ros
    made = 2026-11-23T07:30:00Z
    send_with = yes
    secret = 1f0c...

``ros`` is the bridge, as in a row's ``direction``.
"""

from __future__ import annotations

import configparser
import os
import re
import secrets
from collections.abc import Iterable
from dataclasses import dataclass
from datetime import datetime, timezone
from pathlib import Path

from roverlink import bounded_files
from roverlink.runtime.atomic_files import replacing
from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.core.signing import KEY_BYTES, Key, ticks
from roverlink.runtime.private_files import create_private, read_private

BRIDGE = "ros"
"""Name of the bridge in a key file."""
SUFFIX = ".keys"
_LARGEST_FILE = 65_536  # bytes; 256 keys have less
_OPTIONS = ("from", "to", "made", "send_with", "secret")
_YES_NO = {"yes": True, "no": False}
_TIME = "%Y-%m-%dT%H:%M:%SZ"
_EARLIEST_YEAR = 2025
_SECTION = re.compile(r"key ([0-9]{1,3})")
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
_HEADER = """\
# Keys for the signatures of roverlink, between the bridge (ros) and {end}. Both ends have a copy of this file.
# Whoever can read it can command the rover. Only its owner may read it: chmod 600.
"""
_KEY = """
[key {id}]
from = {sender}
to = {receiver}
made = {made}
send_with = {send_with}
secret = {secret}
"""


@dataclass(frozen=True, slots=True)
class FileKey:
    """Key in a key file."""

    key: Key
    receiver: str
    """Name of the peer or board that verifies with the key; ``ros`` for the bridge."""
    made: int
    """Timestamp of the key's creation; no datagram is older."""
    send_with: bool
    """True if the sender signs with the key; False if the receiver only has to accept it."""

    @property
    def end(self) -> str:
        """Name of the peer or board at the other end of the bridge's link."""
        return self.receiver if self.key.sender == BRIDGE else self.key.sender


def read_keys(path: Path) -> tuple[FileKey, ...]:
    """Return the keys in a key file.

    Raises `SetupError` with file and section if the file cannot be used. No error contains a part of a secret.
    """
    try:
        text = read_private(path, "the keys", _LARGEST_FILE).decode()
    except FileNotFoundError as error:
        raise SetupError(f"{path}: no such key file; `roverlink link keygen` makes one") from error
    except OSError as error:
        raise SetupError(f"{path}: cannot read the key file: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise SetupError(f"{path}: the key file is not UTF-8 text") from error
    parser = configparser.ConfigParser(interpolation=None, default_section="")
    try:
        parser.read_string(text)
    except (configparser.DuplicateSectionError, configparser.DuplicateOptionError) as error:
        raise SetupError(f"{path}:{error.lineno}: the section or option occurs twice; keep one of them") from None
    # Not its text, and not chained: both show the wrong line, which may be a secret.
    except configparser.MissingSectionHeaderError as error:
        raise SetupError(f"{path}:{error.lineno}: the line stands before the first section, such as [key 1]") from None
    except configparser.ParsingError as error:
        raise SetupError(f"{path}:{error.errors[0][0]}: the line is not like `from = basestation`") from None
    keys = tuple(_key(path, name, dict(parser[name])) for name in parser.sections())
    if not keys:
        raise SetupError(f"{path}: the file has no keys; `roverlink link keygen` makes a file with keys")
    _check_marks(path, keys)
    return keys


def make_key_file(path: Path, end: str, now: datetime) -> tuple[FileKey, ...]:
    """Make the key file of the link between the bridge and a peer or board; return its keys, one for each direction.

    Raises `SetupError` if the file exists, or cannot be written, or if the name or ``now`` cannot be right.
    """
    if end == BRIDGE or not _NAME.fullmatch(end):
        raise SetupError(f"{end!r} is not the name of a peer or board, such as basestation or ArmBoard")
    keys = _new_keys(path, end, now, send_with=True)
    try:
        create_private(path, _HEADER.format(end=end) + _text(keys, now))
    except FileExistsError as error:
        cure = "to change its keys, add new ones with --rotate; otherwise name another file with --out"
        raise SetupError(f"{path}: the file exists; {cure}") from error
    except OSError as error:
        raise SetupError(f"{path}: cannot write the key file: {error.strerror}") from error
    return keys


def add_keys(path: Path, end: str, now: datetime) -> tuple[FileKey, ...]:
    """Add a key for each direction to a key file and return both. No end signs with them until they are marked.

    Raises `SetupError` if the file cannot be used, or has no key for this peer or board.
    """
    known = read_keys(path)
    if all(key.end != end for key in known):
        ends = ", ".join(sorted({key.end for key in known}))
        raise SetupError(f"{path}: the file has no keys of {end!r}, only of {ends}")
    keys = _new_keys(path, end, now, send_with=False)
    try:
        with replacing(path) as part:
            create_private(part, bounded_files.read_text(path) + _text(keys, now))
    except OSError as error:
        raise SetupError(f"{path}: cannot write the key file: {error.strerror}") from error
    return keys


def _new_keys(path: Path, end: str, now: datetime, *, send_with: bool) -> tuple[FileKey, ...]:
    if now.year < _EARLIEST_YEAR:
        raise SetupError(f"the clock of this computer says {now:%Y-%m-%d}; set it first, because keys carry their time")
    texts = [bounded_files.read(file, _LARGEST_FILE).decode(errors="replace") for file in _key_files(path)]
    taken = {int(id) for text in texts for id in _SECTION.findall(text)}
    free = [id for id in range(1, 256) if id not in taken]
    if len(free) < 2:
        raise SetupError(f"the key files in {path.resolve().parent} have no free key ids; remove old keys")
    return tuple(
        FileKey(Key(id, sender, secrets.token_bytes(KEY_BYTES)), receiver, _ticks(now), send_with)
        for id, sender, receiver in ((free[0], end, BRIDGE), (free[1], BRIDGE, end))
    )


def _key_files(path: Path) -> Iterable[Path]:
    """Yield the key files in the folder of ``path``: the bridge may read all of them, so their ids must differ."""
    for file in {path, *path.resolve().parent.glob(f"*{SUFFIX}")}:
        if file.is_file() and os.access(file, os.R_OK):
            yield file


def _text(keys: Iterable[FileKey], now: datetime) -> str:
    return "".join(
        _KEY.format(
            id=file_key.key.id,
            sender=file_key.key.sender,
            receiver=file_key.receiver,
            made=now.strftime(_TIME),
            send_with="yes" if file_key.send_with else "no",
            secret=file_key.key.secret.hex(),
        )
        for file_key in keys
    )


def _key(path: Path, name: str, options: dict[str, str]) -> FileKey:
    """Return the key of a section; the errors name options, but no values."""
    where = f"{path}: [{name}]"
    number = _SECTION.fullmatch(name)
    if number is None or int(number[1]) > 255:
        raise SetupError(f"{path}: a section must be [key N] with a number up to 255")
    if missing := [option for option in _OPTIONS if not options.get(option)]:
        raise SetupError(f"{where}: `{missing[0]}` is missing")
    if len(options) != len(_OPTIONS):
        raise SetupError(f"{where}: there is an unknown option; known: {', '.join(_OPTIONS)}")
    if (options["from"] == BRIDGE) == (options["to"] == BRIDGE):
        raise SetupError(f"{where}: either `from` or `to` must be {BRIDGE}, the bridge")
    if options["send_with"] not in _YES_NO:
        raise SetupError(f"{where}: `send_with` must be yes or no")
    try:
        made = datetime.strptime(options["made"], _TIME).replace(tzinfo=timezone.utc)
    except ValueError:
        raise SetupError(f"{where}: `made` must be a time such as 2026-11-23T07:30:00Z") from None
    try:
        secret = bytes.fromhex(options["secret"])
    except ValueError:
        secret = b""  # not chained: the text of the error may show a part of the secret
    if len(secret) != KEY_BYTES:
        raise SetupError(f"{where}: `secret` must have {2 * KEY_BYTES} hexadecimal digits")
    key = Key(int(number[1]), options["from"], secret)
    return FileKey(key, options["to"], _ticks(made), _YES_NO[options["send_with"]])


def _check_marks(path: Path, keys: tuple[FileKey, ...]) -> None:
    """Raise `SetupError` if there is not exactly one key to send with, for a sender and its receiver."""
    for sender, receiver in dict.fromkeys((file_key.key.sender, file_key.receiver) for file_key in keys):
        of_both = [file_key for file_key in keys if (file_key.key.sender, file_key.receiver) == (sender, receiver)]
        if sum(file_key.send_with for file_key in of_both) != 1:
            numbers = ", ".join(str(file_key.key.id) for file_key in of_both)
            which = f"the keys {numbers} from {sender} to {receiver}" if of_both[1:] else f"the key {numbers}"
            raise SetupError(f"{path}: write `send_with = yes` for exactly one of {which}")


def _ticks(time: datetime) -> int:
    return ticks(int(time.timestamp()) * 10**9)
