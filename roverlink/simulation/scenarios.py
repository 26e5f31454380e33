"""Datagrams of simulated boards and of a simulated basestation, and scenarios: the faults that a user can select.

A scenario is a function that takes a stream of datagrams and yields a changed stream, for example with some datagrams
lost. So scenarios can be combined. All random choices come from one generator of random numbers: the same seed gives
the same stream.
"""

from __future__ import annotations

import dataclasses
import heapq
import itertools
import random
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from google.protobuf.message import DecodeError

from roverlink.generator.example_payloads import payload_at
from roverlink.runtime import Registry, SetupError
from roverlink.runtime.core.envelope import restore, strip_trailing_zeros
from roverlink.runtime.core.handler import RowRequest
from roverlink.runtime.core.link_message import NAME, PERIOD_S, LinkWriter
from roverlink.runtime.core.registry import AnyHandler, EndName
from roverlink.runtime.core.wire_format import DELIMITED, VARINT, encoded_varint
from roverlink.simulation.simulated_keys import SimulatedKeys


@dataclass(frozen=True, slots=True)
class Emission:
    """Datagram that a simulated peer sends at a certain time."""

    at: float
    """Time at which the datagram is sent, in seconds since the start."""
    peer: str
    name: str
    """Name of the row whose payload the datagram contains, or contained before a scenario changed the datagram."""
    datagram: bytes
    life: int = 0
    """Number of times that the peer has restarted; after each restart it sends from a new port."""
    end: EndName | None = None
    """End that sends the datagram, if it is a link message; else None."""


Stream = Iterator[Emission]


@dataclass(frozen=True)
class World:
    """Objects that every scenario needs in addition to the stream of datagrams, such as the table."""

    registry: Registry
    rng: random.Random
    longest: int
    """Length in bytes of the longest datagram that the bridge accepts."""
    keys: SimulatedKeys | None = None
    """Keys of the peers that must sign; None if no peer must."""
    writers: dict[tuple[EndName, int], LinkWriter] = dataclasses.field(default_factory=dict)
    """Writers of the link messages of each end, from one start of the end to the next."""

    def writer(self, end: EndName, life: int = 0) -> LinkWriter:
        """Return the writer of an end's link messages; ``life`` is the number of times that the end has restarted."""
        if (end, life) not in self.writers:
            hashes = self.registry.link.hashes if self.registry.link else {}
            own = [handler.route for handler in self.registry.handlers if end_of(handler) == end]
            told = {route.number: hashes[route.number] for route in own}
            self.writers[end, life] = LinkWriter(self.registry.envelope, self.rng.getrandbits(32), told)
        return self.writers[end, life]

    def count_sent(self, end: EndName, life: int = 0) -> None:
        """Count a datagram that the program at an end sends, for its link messages."""
        if self.registry.link is not None:
            self.writer(end, life).count_sent(1)

    def datagram(self, name: str, seconds: float, **fields: int) -> bytes:
        """Return a serialized envelope with the payload of the row ``name``, signed if the row's peer must sign.

        The payload has the simulated values of the time ``seconds`` after the peer's start, except for ``fields``.
        """
        handler = self.registry.by_name[name]
        payload = payload_at(handler.payload_type, seconds)
        for field, value in fields.items():
            setattr(payload, field, value)
        if stamp := self.registry.board_stamps.get(name):
            stamp.set(payload, round(seconds * 1e9))
        return self.signed(end_of(handler), self.registry.datagram(name, payload))

    def answer(self, datagram: bytes, seconds: float, lives: Mapping[str, int]) -> Emission | None:
        """Return the response of a peer to a datagram of the bridge; None if the datagram is no request.

        ``lives`` is the number of times that each peer has restarted, by the peer's name.
        """
        try:
            envelope = self.registry.envelope.FromString(restore(datagram))
        except DecodeError:
            return None
        name = envelope.WhichOneof(self.registry.oneof) or ""
        if (request := self.requests.get(name)) is None:
            return None
        end = end_of(self.registry.by_name[request.response])
        life = lives.get(end.peer, 0)
        fields = {request.field: request.number_in(getattr(envelope, name))} if request.field else {}
        self.count_sent(end, life)
        return Emission(seconds, end.peer, request.response, self.datagram(request.response, seconds, **fields), life)

    def link_message(self, end: EndName, seconds: float, life: int = 0) -> bytes:
        """Return the next link message of an end, signed if the end must sign.

        ``seconds`` is the time since the end's start; ``life`` is the number of times that it has restarted.
        """
        return self.signed(end, self.writer(end, life).write(_microseconds(seconds)))

    def signed(self, end: EndName, datagram: bytes) -> bytes:
        """Return a datagram with a signature if the end must sign."""
        return datagram if self.keys is None else self.keys.sign(end, datagram)

    def unsigned(self, end: EndName, datagram: bytes) -> bytes:
        """Return a datagram of an end without its signature."""
        return datagram if self.keys is None else self.keys.unsigned(end, datagram)

    def sender_of(self, emission: Emission) -> EndName:
        """Return the end that sends a datagram."""
        return emission.end or end_of(self.registry.by_name[emission.name])

    @cached_property
    def requests(self) -> dict[str, RowRequest]:
        """Requests to peers, by the row's name."""
        routes = [handler.route for handler in self.registry.handlers if not handler.route.inbound]
        return {route.name: route.request for route in routes if route.request is not None}

    @property
    def inbound(self) -> list[AnyHandler]:
        """Handlers of the rows whose payloads peers send without a request."""
        responses = {request.response for request in self.requests.values()}
        return [one for one in self.registry.handlers if one.route.inbound and one.route.name not in responses]

    def unused_number(self) -> int:
        """Return an envelope number that no row has; a retired number if there is one."""
        used = {*self.registry.by_number, *([self.registry.link.number] if self.registry.link else [])}
        candidates = itertools.chain(self.registry.retired, itertools.count(1))
        return next(number for number in candidates if number not in used)


def end_of(handler: AnyHandler) -> EndName:
    """Return the end to which a row belongs: a board, or a peer that has no boards."""
    return EndName(handler.route.peer, handler.route.board)


def steady(world: World, rate: float) -> Stream:
    """Yield datagrams without faults and without end: one of each row whose payload comes from a peer, in turn.

    ``rate`` is the number of datagrams a second, of all rows together. If the table has the link message, each board
    and each peer sends one a second, too. The stream is empty if the peers only answer requests.
    """
    rows = world.inbound
    period = 1 / rate if rows else PERIOD_S
    ends = [] if world.registry.link is None else sorted({end_of(handler) for handler in world.registry.handlers})
    told = 0.0
    for index in itertools.count() if rows or ends else ():
        at = index * period
        for end in ends if at >= told else ():
            yield Emission(at, end.peer, NAME, world.link_message(end, at), end=end)
        told += PERIOD_S if at >= told else 0.0
        for handler in rows[index % len(rows) :][:1] if rows else ():
            world.count_sent(end_of(handler))
            yield Emission(at, handler.route.peer, handler.route.name, world.datagram(handler.route.name, at))


def _microseconds(seconds: float) -> int:
    return round(seconds * 1e6)


# --- scenarios --------------------------------------------------------------------------------------------------


def lossy(stream: Stream, world: World) -> Stream:
    """Simulate a radio link: a tenth of the datagrams is lost, some arrive twice, late or out of order."""
    # The index decides between equal times: emissions themselves have no order, and heapq would compare them.
    late: list[tuple[float, int, Emission]] = []
    for index, emission in enumerate(stream):
        while late and late[0][0] <= emission.at:
            at, _, held = heapq.heappop(late)
            yield dataclasses.replace(held, at=at)
        chance = world.rng.random()
        if chance < _LOST:
            continue
        if chance < _LOST + _LATE:
            heapq.heappush(late, (emission.at + world.rng.uniform(0, _DELAY_S), index, emission))
            continue
        yield emission
        if chance > 1 - _TWICE:
            yield emission


_LOST, _LATE, _TWICE, _DELAY_S = 0.1, 0.05, 0.05, 0.2


def stale(stream: Stream, world: World) -> Stream:
    """Simulate a stuck program on a board: it repeats the same values for seconds."""
    held: dict[str, Emission] = {}
    for emission in stream:
        if emission.end is not None:
            yield emission
            continue
        before = held.get(emission.name)
        if before is None or emission.at - before.at > world.rng.uniform(1, 5):
            held[emission.name] = before = emission
        yield _sent_anew(emission, before.datagram, world)


def _sent_anew(emission: Emission, datagram: bytes, world: World) -> Emission:
    """Return the emission of a datagram that the program at the end sends once more, with a signature of its own."""
    sender = world.sender_of(emission)
    again = world.signed(sender, world.unsigned(sender, datagram))
    return dataclasses.replace(emission, datagram=again)


def old_schema(stream: Stream, world: World) -> Stream:
    """Simulate boards with other .proto files: unknown fields, missing fields, payloads without a row."""
    for emission in stream:
        if emission.end is not None:
            yield dataclasses.replace(emission, datagram=_with_other_hashes(emission.end, emission.datagram, world))
            continue
        chance = world.rng.random()
        if chance < _OF_NO_ROW:
            content = b"\x08" + bytes([world.rng.randrange(128)])
            unknown = world.signed(world.sender_of(emission), _delimited(world.unused_number(), content))
            yield dataclasses.replace(emission, datagram=unknown)
        elif chance < 0.5:
            yield dataclasses.replace(emission, datagram=_of_other_protos(emission, world))
        else:
            yield emission


_OF_NO_ROW = 0.1
_NEWER_FIELD = 1000


def _of_other_protos(emission: Emission, world: World) -> bytes:
    """Return a datagram whose payload lacks the message's last field, and has a field that the rover does not know."""
    handler = world.registry.by_name[emission.name]
    payload = payload_at(handler.payload_type, emission.at)
    fields = handler.payload_type.DESCRIPTOR.fields
    if fields:
        payload.ClearField(fields[-1].name)
    newer = _tag(_NEWER_FIELD, VARINT) + b"\x2a"
    return world.signed(end_of(handler), _delimited(handler.route.number, payload.SerializeToString() + newer))


def _with_other_hashes(end: EndName, datagram: bytes, world: World) -> bytes:
    """Return a link message of an end with other hashes of the rows that come from peers."""
    try:
        envelope: Any = world.registry.envelope.FromString(restore(world.unsigned(end, datagram)))
    except DecodeError:
        return datagram  # the scenario malformed has damaged it
    for index, number in zip(range(len(envelope.link.hashes)), envelope.link.numbers):
        handler = world.registry.by_number.get(number)
        if handler is not None and handler.route.inbound:
            envelope.link.hashes[index] ^= 1
    return world.signed(end, envelope.SerializeToString())


def _tag(number: int, wire_type: int) -> bytes:
    return encoded_varint(number << 3 | wire_type)


def _delimited(number: int, content: bytes) -> bytes:
    return _tag(number, DELIMITED) + encoded_varint(len(content)) + content


def padded(stream: Stream, world: World) -> Stream:
    """Simulate boards that pad datagrams with zeros, strip trailing zeros, or do neither."""
    for emission in stream:
        datagram = emission.datagram
        size = world.rng.choice((0, 0, _BUFFER))
        changed = datagram.ljust(min(size, world.longest), b"\0") if size else datagram
        if not size and world.rng.random() < 0.5:
            changed = strip_trailing_zeros(datagram)
        yield dataclasses.replace(emission, datagram=changed)


_BUFFER = 256


def malformed(stream: Stream, world: World) -> Stream:
    """Damage one datagram in five: cut, with a flipped bit, too long, empty, random, or of the wrong direction."""
    for emission in stream:
        if emission.datagram and world.rng.random() < _DAMAGED:
            damage = world.rng.choice(_DAMAGES)
            emission = dataclasses.replace(emission, datagram=damage(emission.datagram, world))
        yield emission


_DAMAGED = 0.2


def _cut(datagram: bytes, world: World) -> bytes:
    return datagram[: world.rng.randrange(len(datagram))]


def _flipped(datagram: bytes, world: World) -> bytes:
    changed = bytearray(datagram)
    changed[world.rng.randrange(len(changed))] ^= 1 << world.rng.randrange(8)
    return bytes(changed)


def _too_long(datagram: bytes, world: World) -> bytes:
    return datagram.ljust(world.longest + 1 + world.rng.randrange(100), b"\0")


def _noise(datagram: bytes, world: World) -> bytes:
    return world.rng.randbytes(1 + world.rng.randrange(2 * len(datagram)))


def _of_the_other_direction(datagram: bytes, world: World) -> bytes:
    outbound = [handler for handler in world.registry.handlers if not handler.route.inbound]
    if not outbound:
        return _noise(datagram, world)
    handler = world.rng.choice(outbound)
    # Without a signature: that of another board, from this board's socket, may overtake what the other board sends.
    return world.registry.datagram(handler.route.name, payload_at(handler.payload_type, 1.0))


_DAMAGES = (_cut, _flipped, _too_long, _noise, _of_the_other_direction)


def flood(stream: Stream, world: World) -> Stream:
    """Send each datagram of one row a hundred times."""
    mad = world.rng.choice(world.inbound).route.name
    for emission in stream:
        yield emission
        for _ in range(_MANY - 1 if emission.name == mad else 0):
            world.count_sent(world.sender_of(emission), emission.life)
            yield _sent_anew(emission, emission.datagram, world)


_MANY = 100


def reboot(stream: Stream, world: World) -> Stream:
    """Simulate peers that stop for a second now and then, and restart at time 0, with another UDP port."""
    lives: dict[str, tuple[int, float, float]] = {}
    for emission in stream:
        life, born, dies = lives.get(emission.peer, (0, 0.0, world.rng.uniform(2, 6)))
        if emission.at >= dies:
            life, born, dies = life + 1, dies + _OUTAGE_S, dies + world.rng.uniform(3, 8)
        lives[emission.peer] = life, born, dies
        if emission.at >= born:
            datagram = _of_life(emission, life, born, world) if life else emission.datagram
            yield dataclasses.replace(emission, life=life, datagram=datagram)


def _of_life(emission: Emission, life: int, born: float, world: World) -> bytes:
    """Return the datagram that a peer sends after ``life`` restarts, the last one at the time ``born``."""
    if emission.end is not None:
        return world.link_message(emission.end, emission.at - born, life)
    world.count_sent(world.sender_of(emission), life)
    return world.datagram(emission.name, emission.at - born)


_OUTAGE_S = 1.0


def hostile(stream: Stream, world: World) -> Stream:
    """Follow one signed datagram in five by an attack: forged, unsigned, shortened, replayed, or an old timestamp."""
    for emission in stream:
        yield emission
        sender = world.sender_of(emission)
        if world.keys is not None and world.keys.must_sign(sender) and world.rng.random() < _ATTACKED:
            attack = world.rng.choice(_ATTACKS)
            yield dataclasses.replace(emission, datagram=attack(world.keys, sender, emission.datagram))


_ATTACKED = 0.2
_ATTACKS = (
    SimulatedKeys.forged,
    SimulatedKeys.outdated,
    SimulatedKeys.replayed,
    SimulatedKeys.shortened,
    SimulatedKeys.unsigned,
)

SCENARIOS: dict[str, Callable[[Stream, World], Stream]] = {
    "lossy": lossy,
    "stale": stale,
    "old-schema": old_schema,
    "padded": padded,
    "malformed": malformed,
    "flood": flood,
    "reboot": reboot,
    "hostile": hostile,
}
"""Scenarios by their name in the option ``--scenario``. The help shows the first line of their documentation."""


def emissions(world: World, rate: float, names: list[str]) -> Stream:
    """Return the stream of datagrams of all peers, changed by the scenarios ``names`` one after the other.

    The stream has no end and is in order of time. ``rate`` is the number of datagrams a second before the changes.
    ``names`` are keys of `SCENARIOS`, such as ``lossy``. Raises `SetupError` if a scenario has nothing to do.
    """
    if hostile.__name__ in names and not any(peer.must_sign for peer in world.registry.peers):
        raise SetupError("the scenario hostile attacks peers that must sign (table key `sign`), but the table has none")
    stream = steady(world, rate)
    for name in names:
        stream = SCENARIOS[name](stream, world)
    return stream
