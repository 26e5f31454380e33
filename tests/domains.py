"""DDS domains that nobody else on this host is in."""

from __future__ import annotations

import contextlib
import os
import socket
from collections.abc import Iterator


def claimed_domain(held: contextlib.ExitStack) -> int:
    """A domain that is ours until ``held`` is closed."""
    return next(number for number in _from_own_place(range(1, 101)) if _claimed(number, held))


def _from_own_place(numbers: range) -> Iterator[int]:
    """Each of the numbers, starting where other processes are unlikely to start."""
    start = os.getpid() % len(numbers)
    return (numbers[(start + step) % len(numbers)] for step in range(len(numbers)))


def _claimed(domain: int, held: contextlib.ExitStack) -> bool:
    """Whether nobody was in the domain, which then is ours: we hold the last of its ports."""
    first_port = 7400 + 250 * domain
    lock = held.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as first_participant:
        try:
            lock.bind(("127.0.0.1", first_port + 249))
            first_participant.bind(("", first_port + 10))
        except OSError:
            return False
    return True
