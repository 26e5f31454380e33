"""Signatures of the datagrams from and to peers that must sign (table key ``sign``)."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path

from roverlink.runtime.bridge import forwarding, to_peer
from roverlink.runtime.core.envelope import restore, strip_trailing_zeros
from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.core.handler import Route
from roverlink.runtime.core.principals import Origin
from roverlink.runtime.core.registry import EndName, Registry
from roverlink.runtime.core.signing import Signer, Stream
from roverlink.runtime.core.translator import Translator, VerifyingTranslator
from roverlink.runtime.keys.signed_links import SignedLinks, owner_of
from roverlink.runtime.net.destination import Destination


def open_links(registry: Registry, files: Sequence[Path], logger: logging.Logger) -> SignedLinks | None:
    """Read the key files of a bridge; return None if the table has no signature, and no file is given.

    Raises `SetupError` if a file cannot be used, or if the table has no use for it.
    """
    if registry.signature is None:
        if files:
            cure = "add `signing: {number: N}` to the table, or leave out the key file"
            raise SetupError(f"{files[0]}: the table has no `signing`, so no datagram can be signed; {cure}")
        return None
    if registry.own is not None:
        (rover,) = registry.peers
        owner = owner_of(registry.own.name, files)
        return SignedLinks(registry.signature, files, logger, owner, bridge=rover.name)
    links = SignedLinks(registry.signature, files, logger)
    boards = {handler.route.board for handler in registry.handlers if handler.route.board}
    links.check_ends([*registry.peers_by_name, *sorted(boards)])
    return links


class SignedPeers:
    """Signatures of one bridge: it verifies what peers send that must sign, and signs what goes to them."""

    def __init__(self, registry: Registry, links: SignedLinks | None) -> None:
        """Raise `SetupError` if a key is missing."""
        self._registry, self._links = registry, links
        self.must_sign = {peer.name for peer in registry.peers if peer.must_sign}
        """Names of the peers that must sign."""
        for missing in self._missing_keys():
            raise SetupError(missing)

    def translator(self, origin: Origin | None = None) -> Translator:
        """Return a translator of the payloads of an origin (None: of all) that refuses datagrams without signature.

        If no peer must sign, its work is that of a plain `Translator`.
        """
        if self._links is None or not self.must_sign:
            return Translator(self._registry, origin)
        return VerifyingTranslator(self._registry, self._links.verifier, origin)

    def signing(self, end: EndName) -> Callable[[bytes], bytes] | None:
        """Return the function that signs a datagram to an end, whoever has made it; None if the peer need not sign."""
        sender = self._sender(end)
        return None if sender is None else sender.signed

    def sending(self, end: EndName, send: to_peer.Send, destination: Destination) -> to_peer.Send:
        """Return a function that sends datagrams with ``send``, and signs them before if the peer must sign.

        What goes over a line is signed when the line is free (`Destination.seal`).
        """
        sender = self._sender(end)
        return send if sender is None else partial(sender.send, send, destination)

    def forwarding(self, send: forwarding.Send) -> forwarding.Send:
        """Return a function that signs and sends datagrams as another peer has sent them.

        A signature of that peer stays in front of ours, so that the receiver can verify it, too.
        """
        senders = {end: sender for end in self._registry.ends if (sender := self._sender(end))}

        def forward(datagrams: Sequence[bytes], destination: Destination) -> int:
            sender = senders.get(destination.end)
            if sender is None:
                return send(datagrams, destination)
            return sender.send(lambda signed: send(signed, destination), destination, datagrams)

        return forward if senders else send

    def signer(self, peer: str, board: str) -> Signer | None:
        """Return the signer of what goes to a peer or its board; None if the peer need not sign."""
        return self._links.signer((board, peer)) if self._links is not None and peer in self.must_sign else None

    def streams(self, route: Route) -> list[Stream]:
        """Return the streams of the keys that may sign the datagrams of a row whose peer must sign."""
        streams = self._links.verifier.streams.values() if self._links is not None else ()
        return [stream for stream in streams if stream.sender in (route.peer, route.board)]

    def _sender(self, end: EndName) -> _SignedSender | None:
        signer = self.signer(*end)
        strips_zeros = self._registry.peers_by_name[end.peer].strip_trailing_zeros
        return None if signer is None else _SignedSender(signer, strips_zeros)

    def _missing_keys(self) -> Iterator[str]:
        """Yield a text for each direction of a peer that must sign, but has no key for it."""
        for handler in (*self._registry.handlers, *self._registry.extra_topics):
            route = handler.route
            ends = tuple(filter(None, (route.board, route.peer)))
            if route.peer in self.must_sign:
                has_key = self._links and (self._links.hears(ends) if route.inbound else self._links.signer(ends))
                if not has_key:
                    yield self._without_key(" or ".join(map(repr, ends)), ends[-1])
        # Boards at one address share a key for what goes to all of them: forwarded datagrams and link messages.
        forwarded = {
            peer for handler in self._registry.handlers if handler.route.inbound for peer in handler.route.forward
        }
        for peer, board in self._registry.ends:
            gets_these = peer in self.must_sign and (self._registry.link is not None or peer in forwarded)
            if gets_these and not (self._links and self._links.signer((board, peer))):
                yield self._without_key(repr(board or peer), board or peer)

    def _without_key(self, who: str, end: str) -> str:
        if self._registry.own is not None:
            end = self._registry.own.name.peer
            cure = f"give a copy of the key file of {end!r} that the rover has with --key-file FILE"
        else:
            cure = f"make a key file with `roverlink link keygen {end}`, and give it to the bridge with --key-file FILE"
        return f"datagrams of {who} must be signed (table key `sign`), but there is no key; {cure}"


class _SignedSender:
    """Sender of signed datagrams to one peer or board. The receiver accepts only datagrams in the order of signing."""

    def __init__(self, signer: Signer, strips_zeros: bool) -> None:
        self._signer, self._strips_zeros = signer, strips_zeros

    def signed(self, datagram: bytes) -> bytes:
        """Sign a datagram whose trailing zeros may be stripped, or zeros appended to it."""
        signed = self._signer.sign(restore(datagram))
        return strip_trailing_zeros(signed) if self._strips_zeros else signed

    def send(self, send: to_peer.Send, destination: Destination, datagrams: Sequence[bytes]) -> int:
        """Sign datagrams, unless they are signed on their way, and send them."""
        if seal := destination.seal:
            return send([seal + datagram for datagram in datagrams])
        with self._signer.lock:
            return send([*map(self.signed, datagrams)])
