"""Addresses of the ends of the link: look-up of host names, learned addresses, and their events.

An end is a peer, or a board of a peer that has ``boards`` in the table. Several threads take part:
- A `HostWatch` for each host that is not a plain IP address looks the host up at the start and periodically, and also
  after a failure to send.
- The receiving thread learns the address of an end whose host is ``learn``.
- The thread of a ROS 2 tool changes the hosts by setting parameters.
- The threads of a `Carrier` for each end that has another transport than UDP.
"""

from __future__ import annotations

import contextlib
import logging
import secrets
import socket
import threading
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from enum import Enum
from functools import partial
from typing import NamedTuple

from roverlink.runtime.bridge.counters import Counters
from roverlink.runtime.core.registry import End, EndName, Registry
from roverlink.runtime.net import hosts
from roverlink.runtime.net.carrier import Carrier
from roverlink.runtime.net.destination import Destination, Target
from roverlink.runtime.net.host_watch import HostWatch
from roverlink.runtime.net.hosts import SocketAddress
from roverlink.runtime.net.outbox import Outbox, number_of, priority_by_number
from roverlink.runtime.net.transports import transport_at
from roverlink.runtime.ros_arguments.parameters import EndAddress, Parameters
from roverlink.runtime.text.host_names import LEARN, is_literal


class LinkEvent(str, Enum):
    """Event of the address of an end. The bridge counts each event, and logs it once."""

    NOT_RESOLVED = "not_resolved"
    """A host has no address, or a network interface does not exist."""
    RESOLVED = "resolved"
    """The host has an address."""
    LEARNED = "learned"
    """The first valid datagram of an end whose host is ``learn`` has arrived."""
    ADDRESS_CHANGED = "address_changed"
    """The host has another address than before, or the end sends from another one."""
    UNREACHABLE = "unreachable"
    """The network of this computer refuses datagrams to the address."""
    REACHABLE = "reachable_again"
    """The network accepts datagrams to the address again."""
    CONNECTED = "connected"
    """The line to the end works: the serial device is open, or there is a TCP connection."""
    DISCONNECTED = "disconnected"
    """The line to the end does not work any more, or not yet."""
    ONE_WAY = "one_way"
    """The end has an IPv6 address, but the bridge listens only on IPv4."""


class LinkState(NamedTuple):
    """State of the address of an end."""

    addresses: tuple[str, ...]
    """Addresses with their ports to which datagrams go now, or the line of the end; empty if none is known."""
    state: str
    """``ok``, ``not_learned``, ``not_resolved``, ``not_connected`` or ``unreachable``."""
    fault: str = ""
    """Reason why the line of the end does not work; empty if it works, or if the end has none."""


_GOOD = frozenset({LinkEvent.RESOLVED, LinkEvent.LEARNED, LinkEvent.REACHABLE, LinkEvent.CONNECTED})

_SEAL = 16  # bytes

Note = Callable[[LinkEvent, str], None]
"""Function that counts an event of an end, and logs its text."""
Sign = Callable[[bytes], bytes]
"""Function that returns a datagram with a signature."""


class Ends:
    """Destinations of all ends of the link, which follow the parameters and the network."""

    def __init__(
        self,
        registry: Registry,
        parameters: Parameters,
        counters: Counters,
        own: socket.socket,
        signing: Callable[[EndName], Sign | None] = lambda _: None,
    ) -> None:
        """Direct the destinations to the hosts that are IP addresses; `start` looks up the others.

        ``own`` is the socket on which the bridge receives. If it receives only IPv4, names get IPv4 addresses.
        ``signing`` returns the function that signs what leaves over the line of an end.
        """
        self.on_reached: Callable[[EndName], None] = lambda _: None
        """Function that is called when an end has another address, is reachable again, or its line works."""
        # The rover learns the port from which our datagrams come, and sends there.
        shared = own if registry.own is not None and not registry.own.port else None
        priority_of = priority_by_number(registry)

        def note(name: EndName, event: LinkEvent, text: str) -> None:
            level = logging.INFO if event in _GOOD else logging.WARNING
            counters.count_link_event(name.peer, name.board, event.value, f"{name}: {text}", level)
            if event in _GOOD or event is LinkEvent.ADDRESS_CHANGED:
                self.on_reached(name)

        self._steered = {
            name: _Steering(
                name,
                end,
                partial(note, name),
                own,
                shared,
                lambda seal: Outbox(lambda one: priority_of(number_of(one.removeprefix(seal), registry.signature))),
                signing(name),
            )
            for name, end in registry.ends.items()
        }
        self.destinations: Mapping[EndName, Destination] = {
            name: steering.destination for name, steering in self._steered.items()
        }
        """Destination of each end."""
        self._by_row = {
            handler.route.name: self._steered[end]
            for handler in registry.handlers
            if handler.route.inbound and (end := registry.end_of(handler.route)) in self._steered
        }
        self.follow(parameters)

    def of_peer(self, peer: str) -> list[Destination]:
        """Return the destinations of a peer: one, or one for each of its boards."""
        return [destination for name, destination in self.destinations.items() if name.peer == peer]

    def start(self) -> None:
        """Start the threads that look up hosts."""
        for steering in self._steered.values():
            steering.start()

    def follow(self, parameters: Parameters) -> None:
        """Direct the datagrams of each end to the hosts and the port in ``parameters`` from now on."""
        for name, steering in self._steered.items():
            steering.follow(parameters.addresses[name])

    def learn(self, rows: Sequence[str | None], speakers: Sequence[EndName], sender: SocketAddress) -> None:
        """Learn the address of the ends whose rows or link messages have come from a sender.

        ``rows`` holds the payload name of each datagram, or None if the datagram was refused. ``speakers`` are the ends
        whose link messages have come; a peer with boards speaks for all of them.
        """
        for row in rows:
            if row in self._by_row:
                self._by_row[row].learn(sender)
        for speaker in speakers:
            for name, steering in self._steered.items():
                if name.peer == speaker.peer and (name.board == speaker.board or "" in (name.board, speaker.board)):
                    steering.learn(sender)

    def knows(self, row: str, sender: SocketAddress) -> bool:
        """Return true if a datagram of a row from a sender teaches nothing: its end learns no address, or has this."""
        steering = self._by_row.get(row)
        return steering is None or steering.knows(sender)

    def states(self) -> dict[EndName, LinkState]:
        """Return the addresses of each end, with their state."""
        return {name: steering.link_state() for name, steering in self._steered.items()}

    def lines(self) -> dict[SocketAddress, EndName]:
        """Return the ends that have another transport than UDP, by the address from which their datagrams come."""
        carriers = {name: steering.carrier for name, steering in self._steered.items()}
        return {carrier.address: name for name, carrier in carriers.items() if carrier is not None}

    def undelivered(self) -> Counter[tuple[str, str, str]]:
        """Return the number of datagrams that were not sent over the line of an end, by peer, board and reason."""
        counts: Counter[tuple[str, str, str]] = Counter()
        for name, steering in self._steered.items():
            counts.update({(*name, reason): count for reason, count in steering.undelivered().items() if count})
        return counts

    def damaged(self) -> Counter[tuple[str, str]]:
        """Return the number of frames that were damaged on the line of an end, by peer and board."""
        return Counter({(*name,): count for name, one in self._steered.items() if (count := one.damaged())})

    def close(self) -> None:
        """Stop the threads, and close the sockets."""
        for steering in self._steered.values():
            steering.close()


class _Steering:
    """Steering of one end's destination: it directs the destination to the addresses of the end's hosts."""

    def __init__(
        self,
        name: EndName,
        end: End,
        note: Note,
        own: socket.socket,
        shared: socket.socket | None,
        outbox: Callable[[bytes], Outbox[bytes]],
        sign: Sign | None,
    ) -> None:
        self._end, self._note, self._own, self._outbox, self._sign = end, note, own, outbox, sign
        self._ipv4_only = own.family == socket.AF_INET
        self.destination = Destination(name, report=self._reachability_changed, shared=shared)
        self._lock = threading.RLock()
        self._running = False
        self._wanted = EndAddress((), 0)
        self._targets: dict[str, Target] = {}
        """Target of each host that has an address; for an end that learns, the learned one."""
        self._missing: set[str] = set()
        """Hosts without an address."""
        self._watches: list[HostWatch] = []
        self.carrier: Carrier | None = None
        """Carrier of an end that has another transport than UDP."""
        self._undelivered: Counter[str] = Counter()  # by the carriers that are closed
        self._damaged = 0

    def link_state(self) -> LinkState:
        """Return the addresses of the end, with their state."""
        if (carrier := self.carrier) is None:
            return LinkState(tuple(map(hosts.text_of, self.destination.addresses)), self.state)
        why = carrier.why
        works = why is None and bool(self.destination.addresses)
        return LinkState((carrier.name,), "ok" if works else "not_connected", why or "")

    def undelivered(self) -> Counter[str]:
        """Return the number of datagrams that no carrier has sent, by reason."""
        carrier = self.carrier
        return self._undelivered + (carrier.undelivered if carrier is not None else Counter())

    def damaged(self) -> int:
        """Return the number of frames that were damaged on a line."""
        carrier = self.carrier
        return self._damaged + (carrier.damaged if carrier is not None else 0)

    @property
    def state(self) -> str:
        """State of the end's address: ``ok``, ``not_learned``, ``not_resolved`` or ``unreachable``."""
        if self._learns and not self.destination.addresses:
            return "not_learned"
        if self._missing or not self.destination.addresses:
            return LinkEvent.NOT_RESOLVED.value
        return "ok" if self.destination.is_reachable else LinkEvent.UNREACHABLE.value

    @property
    def _learns(self) -> bool:
        return self._wanted.hosts == (LEARN,)

    def start(self) -> None:
        """Start to look up the hosts."""
        with self._lock:
            self._running = True
            self._start_threads()

    def _start_threads(self) -> None:
        for watch in self._watches:
            watch.start()
        if self.carrier is not None:
            self.carrier.start()

    def follow(self, wanted: EndAddress) -> None:
        """Direct the destination to other hosts, or to another port."""
        with self._lock:
            if wanted == self._wanted:
                return
            self._stop_threads()
            self._wanted, self._targets, self._missing = wanted, {}, set()
            seal = secrets.token_bytes(_SEAL) if wanted.is_line and self._sign is not None else b""
            if seal or self.destination.seal:
                self.destination.direct_to()  # nothing may leave with an old seal, or without a signature
                self.destination.seal = seal
            for host in () if self._learns else wanted.hosts:
                if wanted.is_line:
                    sign = partial(_signed, self._sign, seal) if self._sign is not None else None
                    given = (transport_at(host), self._own, self._connection_changed, self._outbox(seal), sign)
                    self.carrier = Carrier(*given)
                # An address of a network interface needs the interface, which may not be there yet.
                elif is_literal(host) and "%" not in host and not self._end.interface:
                    with contextlib.suppress(OSError):  # it is noted
                        self._look_up(wanted, host)
                else:
                    self._watches.append(HostWatch(partial(self._look_up, wanted, host)))
            self._direct()
            if self._running:
                self._start_threads()

    def knows(self, sender: SocketAddress) -> bool:
        """Return true if a datagram from a sender changes nothing."""
        if not self._learns:
            return True
        learned = self._targets.get(LEARN)
        return learned is not None and learned.address == _with_port(sender, self._wanted.port or sender[1])

    def learn(self, sender: SocketAddress) -> None:
        """Direct the destination to the sender of a datagram, if the end's host is ``learn``."""
        wanted = self._wanted
        if not self._learns:
            return
        before = self._targets.get(LEARN)
        address = _with_port(sender, wanted.port or sender[1])
        if before is not None and before.address == address:
            return
        with self._lock:
            if wanted is not self._wanted:
                return  # the parameters have just changed
            self._targets[LEARN] = Target(address)
            self._direct()
        if before is None:
            self._note(LinkEvent.LEARNED, f"learned the address {hosts.text_of(address)}")
        else:
            self._note(LinkEvent.ADDRESS_CHANGED, _moved(before.address, address))

    def close(self) -> None:
        """Stop the threads, and close the sockets."""
        with self._lock:
            self._stop_threads()
        self.destination.close()

    def _stop_threads(self) -> None:
        for watch in self._watches:
            watch.stop()
        self._watches = []
        if (carrier := self.carrier) is not None:
            carrier.close()
            self.carrier, self._undelivered, self._damaged = None, self.undelivered(), self.damaged()

    def _connection_changed(self, why: str) -> None:
        """Send to the line of the end, or nothing as long as there is no connection: what waits would be stale."""
        with self._lock:
            if (carrier := self.carrier) is None:
                return
            self._targets = {carrier.name: Target(carrier.address)} if carrier.why is None else {}
            self._direct()
        if why:
            self._note(LinkEvent.DISCONNECTED, f"{carrier.name}: {why}")
        else:
            self._note(LinkEvent.CONNECTED, f"connected over {carrier.name}")

    def _look_up(self, wanted: EndAddress, host: str) -> None:
        """Look up a host, and direct the destination to it. Raises `OSError` or `UnicodeError` if it is not found."""
        try:
            found = hosts.look_up(host, wanted.port)
            with self._lock:
                if wanted is not self._wanted:
                    return  # the parameters have changed during the look-up
                before, was_missing = self._targets.get(host), host in self._missing
                target = self._targets[host] = self._target(before, found)
                self._direct()
                self._missing.discard(host)
        except (OSError, UnicodeError) as error:
            with self._lock:
                is_news = wanted is self._wanted and host not in self._missing
                self._missing.add(host)
            if is_news:
                self._note(LinkEvent.NOT_RESOLVED, f"{host} cannot be resolved: {hosts.reason_of(error)}")
            raise
        text = hosts.text_of(target.address)
        if was_missing or (before is None and not is_literal(host)):
            self._note(LinkEvent.RESOLVED, f"{host} is {text}")
        if before is not None and before.address != target.address:
            self._note(LinkEvent.ADDRESS_CHANGED, f"{host}: {_moved(before.address, target.address)}")
        is_heard = not self._ipv4_only or len(target.address) == 2 or hosts.is_multicast(target.address)
        if not is_heard and before is None:
            self._note(
                LinkEvent.ONE_WAY,
                f"{text} is an IPv6 address, but the bridge listens only on IPv4 and cannot hear it; start the bridge "
                "with -p listen_address:=\"'::'\" to hear both",
            )

    def _target(self, before: Target | None, found: Sequence[SocketAddress]) -> Target:
        """Return the target for a host that has the addresses ``found``, and had the target ``before``."""
        if self._ipv4_only:
            found = [address for address in found if len(address) == 2] or found
        # A name with several addresses must not alternate between them.
        address = before.address if before is not None and before.address in found else found[0]
        if not hosts.is_multicast(address):
            return Target(address)
        interface = socket.if_nametoindex(self._end.interface) if self._end.interface else 0
        return Target(address, interface, self._end.ttl)

    def _direct(self) -> None:
        """Direct the destination to the targets, in the order of the hosts."""
        in_order = [self._targets[host] for host in self._wanted.hosts if host in self._targets]
        self.destination.direct_to(*dict.fromkeys(in_order))

    def _reachability_changed(self, address: str, why: str) -> None:
        if why:
            self._note(LinkEvent.UNREACHABLE, f"cannot send to {address}: {why}")
        else:
            self._note(LinkEvent.REACHABLE, f"{address} is reachable again")
        # The host may have another address now, in both cases.
        for watch in self._watches:
            watch.again()


def _signed(sign: Sign, seal: bytes, datagram: bytes) -> bytes:
    """Sign a datagram that the bridge has sealed. Others leave as they are, such as those of the policy ``all``.

    Any program of this computer can send to the carrier, and must not get the signature of the bridge.
    """
    return sign(datagram.removeprefix(seal)) if datagram.startswith(seal) else datagram


def _with_port(address: SocketAddress, port: int) -> SocketAddress:
    return (address[0], port) if len(address) == 2 else (address[0], port, address[2], address[3])


def _moved(before: SocketAddress, after: SocketAddress) -> str:
    return f"the address is now {hosts.text_of(after)} (it was {hosts.text_of(before)})"
