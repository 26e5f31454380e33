"""Section `signing`: the cost of signing and of verifying a datagram, by its length."""

import time
from dataclasses import asdict, dataclass

from bench.lab import Lab
from bench.result import Group, SectionResult, Table
from roverlink.runtime.core.signing import Key, Signer, SigningClock, Verifier

LENGTHS = (20, 80, 400, 1400)
"""Lengths of the unsigned datagrams in bytes."""
LIMIT_US = 3.0
"""Highest cost for a datagram of a usual length, up to 80 bytes."""
ROUNDS, QUICK_ROUNDS = 20, 5
_COUNT = 5_000
_NUMBER = 23


@dataclass(frozen=True, slots=True)
class Cost:
    """Microseconds for one datagram."""

    length: int
    sign: float
    verify: float


def measure(lab: Lab) -> SectionResult:
    """Time both directions of a signed link."""
    costs = [_cost(length, QUICK_ROUNDS if lab.quick else ROUNDS) for length in LENGTHS]
    for cost in costs:
        lab.say(f"signing {cost.length} bytes: {cost.sign:.2f} us, verifying: {cost.verify:.2f} us")
    rows = [(str(cost.length), f"{cost.sign:.2f}", f"{cost.verify:.2f}") for cost in costs]
    table = Table(
        "Signed datagrams",
        ("bytes", "us to sign", "us to verify"),
        [Group("", rows)],
        [f"The limit is {LIMIT_US:g} us up to 80 bytes."],
    )
    return SectionResult([table], data={"costs": [*map(asdict, costs)]})


def _cost(length: int, rounds: int) -> Cost:
    """Return the fastest of some rounds, because other programs only ever make a round slower."""
    key, datagram, senders = Key(1, "board", bytes(range(32))), bytes([0x6A]) * length, frozenset(("board",))
    clock = SigningClock()
    signer, verifier = Signer(_NUMBER, key, clock), Verifier(_NUMBER, [(key, 0, clock)])
    sign = verify = float("inf")
    for _ in range(rounds):
        start = time.perf_counter()
        signed = [signer.sign(datagram) for _ in range(_COUNT)]
        between = time.perf_counter()
        for one in signed:
            verifier.verify(one, senders)
        end = time.perf_counter()
        sign, verify = min(sign, between - start), min(verify, end - between)
    return Cost(length, sign / _COUNT * 1e6, verify / _COUNT * 1e6)
