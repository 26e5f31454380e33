"""Keys of the simulated peers that must sign: for their signatures, and for forgeries."""

from __future__ import annotations

import contextlib
import dataclasses
import secrets
from collections.abc import Sequence
from datetime import datetime, timezone
from pathlib import Path

from roverlink.runtime import Registry, SetupError
from roverlink.runtime.client.signatures import Signatures
from roverlink.runtime.core.envelope import restore
from roverlink.runtime.core.registry import EndName
from roverlink.runtime.core.signing import KEY_BYTES, MAC_BYTES, SIGNATURE_BYTES, Key, Signer, SigningClock, Verifier
from roverlink.runtime.core.translator import Translator, VerifyingTranslator
from roverlink.runtime.keys.key_file import BRIDGE, SUFFIX, make_key_file, read_keys


def make_throw_away_keys(registry: Registry, folder: Path) -> dict[str, Path]:
    """Make a key file for each peer that must sign, and return the files by the names of the peers."""
    files = {peer.name: folder / f"{peer.name}{SUFFIX}" for peer in registry.peers if peer.must_sign}
    for name, file in files.items():
        make_key_file(file, name, datetime.now(timezone.utc))
    return files


class _Sender:
    """Peer or board that signs, and those who pretend to be it."""

    def __init__(self, number: int, key: Key, signatures: Signatures) -> None:
        self.signatures = signatures
        self.honest = signatures.outgoing
        secret = secrets.token_bytes(KEY_BYTES)
        self.clock = signatures.clocks[key.sender]
        self.forger = Signer(number, dataclasses.replace(key, secret=secret), self.clock).sign
        # A clock that starts in 2015: every key was made later.
        self.latecomer = Signer(number, key, SigningClock(wall=lambda: 0)).sign


class SimulatedKeys(contextlib.ExitStack):
    """Keys of all simulated peers and boards that must sign. A context manager, as `Signatures` is."""

    def __init__(self, registry: Registry, files: Sequence[Path]) -> None:
        """Read the key files. A board without a key of its own signs with the key of its peer.

        Raises `SetupError` if a file cannot be used, or if a key is missing.
        """
        super().__init__()
        if registry.signature is None:
            raise SetupError(f"{files[0]}: the table has no `signing`; leave out the key file")
        self._registry, self._number = registry, registry.signature
        self._keys = [(file_key, file) for file in files for file_key in read_keys(file) if file_key.receiver == BRIDGE]
        known = {file_key.key.sender for file_key, _ in self._keys}
        self._senders: dict[str, _Sender] = {}
        self._by_end: dict[EndName, _Sender] = {}
        for handler in registry.handlers:
            peer, board = handler.route.peer, handler.route.board
            if registry.peers_by_name[peer].must_sign:
                self._by_end[EndName(peer, board)] = self._sender(EndName(peer, board if board in known else ""))
        self._size = len(Signer(self._number, Key(0, "", bytes(KEY_BYTES)), SigningClock()).sign(b""))

    def __enter__(self) -> SimulatedKeys:
        for sender in self._senders.values():
            self.enter_context(sender.signatures)
        return self

    def _sender(self, end: EndName) -> _Sender:
        name = end.board or end.peer
        if name not in self._senders:
            own = [
                (file_key.key, file)
                for file_key, file in self._keys
                if file_key.key.sender == name and file_key.send_with
            ]
            if not own:
                cure = "make one with `roverlink link keygen`, or leave out --key-file if simulate starts the bridge"
                raise SetupError(f"{name!r} must sign (table key `sign`), but no key file has a key of it; {cure}")
            key, file = own[0]
            self._senders[name] = _Sender(self._number, key, Signatures(self._registry, end, [file]))
        return self._senders[name]

    def translator(self) -> Translator:
        """Return a translator that accepts what a bridge accepts, if only the simulated peers sign with these keys."""
        keys = [
            (file_key.key, self._senders[file_key.key.sender].clock.last, SigningClock())
            for file_key, _ in self._keys
            if file_key.key.sender in self._senders
        ]
        return VerifyingTranslator(self._registry, Verifier(self._number, keys))

    def must_sign(self, end: EndName) -> bool:
        """Return true if an end must sign."""
        return end in self._by_end

    def sign(self, end: EndName, datagram: bytes) -> bytes:
        """Return a datagram with the signature of an end, if the end must sign."""
        return self._by_end[end].honest(datagram) if end in self._by_end else datagram

    def unsigned(self, end: EndName, datagram: bytes) -> bytes:
        """Return the envelope in a datagram of an end, without the signature at its end."""
        return restore(datagram)[: -self._size] if end in self._by_end else datagram

    # --- attacks on the signed datagrams of an end that must sign ---

    def forged(self, end: EndName, datagram: bytes) -> bytes:
        """Return a signed datagram with another signature, by somebody who does not know the key."""
        return self._by_end[end].forger(self.unsigned(end, datagram))

    def outdated(self, end: EndName, datagram: bytes) -> bytes:
        """Return a signed datagram with another signature, which is older than all others."""
        return self._by_end[end].latecomer(self.unsigned(end, datagram))

    def shortened(self, end: EndName, datagram: bytes) -> bytes:
        """Return a signed datagram whose signature lacks the MAC."""
        signature = self.forged(end, b"")
        tag, value = signature[: -SIGNATURE_BYTES - 1], signature[-SIGNATURE_BYTES:-MAC_BYTES]
        return self.unsigned(end, datagram) + tag + bytes([len(value)]) + value

    def replayed(self, end: EndName, datagram: bytes) -> bytes:  # noqa: ARG002  # as the other attacks
        """Return a signed datagram as it was."""
        return datagram
