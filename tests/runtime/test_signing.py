"""Signatures of datagrams: what a verifier accepts, and the reason for which it refuses everything else."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from roverlink.runtime.core.errors import DatagramError
from roverlink.runtime.core.signing import TICKS_PER_SECOND, Key, Signer, SigningClock, Verifier, ticks

VECTORS = Path(__file__).parents[2] / "cpp/tests/signing_vectors.tsv"
NUMBER = 23
KEY = Key(1, "basestation", bytes(range(32)))
NOW = ticks(1_795_000_000 * 10**9)


class Computer:
    """The clocks of a computer, in seconds."""

    def __init__(self, wall: float = 1_795_000_000, steady: float = 100) -> None:
        self.wall, self.steady = wall, steady

    def clock(self, earliest: int = 0) -> SigningClock:
        """Return the clock of a program that starts now."""
        return SigningClock(earliest, lambda: int(self.wall * 10**9), lambda: int(self.steady * 10**9))

    def passes(self, seconds: float) -> None:
        """Let both clocks run."""
        self.wall, self.steady = self.wall + seconds, self.steady + seconds


def _vectors(kind: str) -> list[list[str]]:
    lines = VECTORS.read_text(encoding="utf-8").splitlines()
    return [line.split("\t")[1:] for line in lines if line.startswith(f"{kind}\t")]


def _verdict(verifier: Verifier, datagram: bytes, sender: str = "basestation") -> str:
    try:
        verifier.verify(datagram, {sender})
    except DatagramError as error:
        return error.reason.value
    return "accepted"


def _verifier(last: int = 0, clock: SigningClock | None = None) -> Verifier:
    return Verifier(NUMBER, [(KEY, last, clock or Computer().clock())])


@pytest.mark.parametrize(("number", "id", "secret", "timestamp", "datagram", "signed"), _vectors("sign"))
def test_signatures_are_those_of_the_vectors(
    number: str, id: str, secret: str, timestamp: str, datagram: str, signed: str
) -> None:
    """Python signs as C and C++ do."""
    clock = SigningClock(int(timestamp) - 1, wall=lambda: 0, steady=lambda: 0)
    signer = Signer(int(number), Key(int(id), "x", bytes.fromhex(secret)), clock)
    assert signer.sign(bytes.fromhex(datagram)).hex() == signed


@pytest.mark.parametrize(("number", "id", "secret", "last", "datagram", "verdict"), _vectors("verify"))
def test_verdicts_are_those_of_the_vectors(
    number: str, id: str, secret: str, last: str, datagram: str, verdict: str
) -> None:
    """Python refuses what C and C++ refuse, for the same reason."""
    clock = SigningClock(int(last), wall=lambda: 0, steady=lambda: 0, made=int(last))
    verifier = Verifier(int(number), [(Key(int(id), "basestation", bytes.fromhex(secret)), int(last), clock)])
    assert _verdict(verifier, bytes.fromhex(datagram)) == verdict


_datagrams = st.builds(
    lambda size, rest: b"\x6a" + bytes([size]) + (rest + bytes(size))[:size], st.integers(0, 127), st.binary()
)


@given(_datagrams, st.data())
def test_a_changed_datagram_is_never_accepted(datagram: bytes, data: st.DataObject) -> None:
    """Any flipped bit, any cut and any byte in addition, except for zeros, is refused."""
    signed = Signer(NUMBER, KEY, Computer().clock()).sign(datagram)
    place = data.draw(st.integers(0, len(signed) - 1))
    flipped = bytearray(signed)
    flipped[place] ^= 1 << data.draw(st.integers(0, 7))
    cut, more = signed[:place], signed + data.draw(st.binary(min_size=1).filter(lambda tail: tail.strip(b"\0") != b""))
    for forged in (bytes(flipped), more, *([cut] if signed[place:].strip(b"\0") else [])):
        assert _verdict(_verifier(), forged) != "accepted"


def test_timestamps_rise_whatever_the_clock_does() -> None:
    """The clock may stand still, be set back or never have been set."""
    computer = Computer()
    clock = computer.clock()
    first = clock.next()
    second = clock.next()  # at the same moment
    computer.wall -= 3600
    computer.steady += 5
    third = clock.next()
    assert first < second < third
    assert third == NOW + 5 * TICKS_PER_SECOND


def test_timestamps_follow_a_clock_that_is_set_later() -> None:
    """A computer without a battery starts in 1970 and gets the time from the network."""
    computer = Computer(wall=0)
    clock = computer.clock()
    assert clock.next() == 1
    computer.wall = 1_795_000_000
    assert clock.next() == NOW


def test_a_sender_without_a_clock_continues_from_what_it_has_verified() -> None:
    """The bridge has no clock; after one command of the basestation, the basestation accepts its datagrams."""
    computer = Computer(wall=0)
    rover, basestation = computer.clock(), Computer().clock()
    _verifier(0, rover).verify(Signer(NUMBER, KEY, basestation).sign(b"\x6a\0"), {"basestation"})
    computer.steady += 5
    key = Key(2, "ros", bytes(32))
    answer = Signer(NUMBER, key, rover).sign(b"\x6a\0")
    assert _verdict(Verifier(NUMBER, [(key, NOW - 100, basestation)]), answer, "ros") == "accepted"


def test_the_largest_timestamp_ends_the_key_without_an_error() -> None:
    """In the year 2104, a signer repeats the last timestamp, which is refused, instead of failing."""
    signer = Signer(NUMBER, KEY, SigningClock(2**48 - 2))
    first, second = signer.sign(b""), signer.sign(b"")
    assert first == second


def test_no_text_contains_a_secret() -> None:
    """Keys appear in logs and errors by their ids only."""
    secret = bytes(range(100, 132))
    key = Key(1, "basestation", secret)
    verifier = Verifier(NUMBER, [(key, 0, Computer().clock())])
    with pytest.raises(DatagramError) as refused:
        verifier.verify(Signer(NUMBER, Key(1, "x", bytes(32)), Computer().clock()).sign(b""), {"basestation"})
    for text in (repr(key), repr(verifier), str(refused.value)):
        assert secret.hex() not in text
        assert repr(secret)[2:-1] not in text
