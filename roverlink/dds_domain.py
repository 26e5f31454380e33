"""DDS domains that no other program on this host is in."""

import os
import socket
from contextlib import ExitStack

# Ports of DDS, from the RTPS specification, section 9.6.1.1: 7400 + 250 * domain, and 10 more for the discovery of the
# first participant. The ports of domains above 100 are in the range that Linux gives to any program.
_FIRST_PORT, _PORTS, _FIRST_PARTICIPANT = 7400, 250, 10
_DOMAINS = range(1, 101)
UNTIL_EXIT = ExitStack()
"""Holds a domain as long as the process runs."""
_claimed = list[int]()


def claim_domain(held: ExitStack) -> int:
    """Return a DDS domain that is ours until ``held`` is closed.

    Two programs that call this function never get the same domain, and neither gets one that another program is in. A
    domain that this process has given back waits until it has had the others: an entity in it may still exist, and then
    Cyclone DDS keeps the configuration of the domain.

    Raises `OSError` if all of the domains are taken.
    """
    start = os.getpid()
    fresh = (_DOMAINS[(start + step) % len(_DOMAINS)] for step in range(len(_DOMAINS)))
    for number in [*(number for number in fresh if number not in _claimed), *_claimed]:
        if _is_claimed(number, held):
            if number in _claimed:
                _claimed.remove(number)
            _claimed.append(number)
            return number
    raise OSError("programs on this host are in all DDS domains from 1 to 100")


def ports_of(domain: int) -> range:
    """Return the UDP ports of a domain. Its participants take them from the first one on, two each."""
    return range(_FIRST_PORT + _PORTS * domain, _FIRST_PORT + _PORTS * (domain + 1))


def _is_claimed(domain: int, held: ExitStack) -> bool:
    """Try to hold the last port of a domain, and see whether its first participant's port is free."""
    ports = ports_of(domain)
    with ExitStack() as opened:
        lock, participant = (opened.enter_context(_udp_socket()) for _ in range(2))
        try:
            lock.bind(("127.0.0.1", ports[-1]))
            participant.bind(("", ports[_FIRST_PARTICIPANT]))
        except OSError:
            return False
        participant.close()
        held.push(opened.pop_all())
    return True


def _udp_socket() -> socket.socket:
    return socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
