"""Signatures of a peer or board: they sign what it sends, and verify what the bridge sends."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from pathlib import Path

from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.core.registry import EndName, Registry
from roverlink.runtime.keys.key_file import BRIDGE
from roverlink.runtime.keys.signed_links import SignedLinks, owner_of

_LOGGER = logging.getLogger(__name__)


class Signatures(SignedLinks):
    """Hook that signs and verifies datagrams with the keys of a peer or board. A context manager; see `SignedLinks`."""

    def __init__(self, registry: Registry, end: EndName, files: Sequence[Path]) -> None:
        """Read the key files of a peer or board. A board without keys of its own uses those of its peer.

        Raises `SetupError` if a file cannot be used, or if a key is missing.
        """
        if registry.signature is None:
            raise SetupError(f"{files[0]}: the table has no `signing`; leave out the key file")
        super().__init__(registry.signature, files, _LOGGER, owner_of(end, files))
        signer = self.signer([BRIDGE])
        if signer is None:
            raise SetupError(f"{files[0]}: the file has no key with which {end} signs datagrams to the bridge")
        self._signer = signer

    def outgoing(self, datagram: bytes) -> bytes:
        """Return the datagram with a signature."""
        return self._signer.sign(datagram)

    def incoming(self, datagram: bytes) -> bytes:
        """Return the datagram. Raises `DatagramError` if the bridge has not signed it, or if it is not new."""
        self.verifier.verify(datagram, frozenset((BRIDGE,)))
        return datagram
