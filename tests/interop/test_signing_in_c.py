"""The signatures in C, for firmware: RFC 7693's own test, the shared vectors, and random datagrams beside Python."""

from __future__ import annotations

import hashlib
import shutil
import subprocess
from collections.abc import Callable, Iterable
from pathlib import Path
from random import Random

import pytest

from roverlink.runtime.core.errors import DatagramError
from roverlink.runtime.core.signing import Key, Signer, SigningClock, Verifier

ROOT = Path(__file__).parents[2]
_OF_RFC_7693 = "6a411f08ce25adcdfb02aba641451cec53c598b24f4fc787fbdc88797f4c1dfe"  # appendix E
_ABC = "508c5e8c327c14e2e1a72ba34eeb452f37458b209ed63a294d999b4c86675982"  # appendix B

Filter = Callable[[Iterable[tuple[object, ...]]], list[str]]


@pytest.fixture(scope="module")
def in_c(tmp_path_factory: pytest.TempPathFactory) -> Filter:
    """Function that lets the C code work on lines of the vectors, given as tuples."""
    if shutil.which("gcc") is None:
        pytest.skip("need a C compiler (apt-get install gcc)")
    program = tmp_path_factory.mktemp("c") / "filter"
    flags = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-O1", f"-I{ROOT / 'cpp/c'}"]
    checks = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all"]
    source = Path(__file__).with_name("signing_filter.c")
    subprocess.run(["gcc", *flags, *checks, str(source), "-o", str(program)], check=True)

    def run(lines: Iterable[tuple[object, ...]]) -> list[str]:
        text = "".join("\t".join(map(str, line)) + "\n" for line in lines)
        return subprocess.run([program], input=text, capture_output=True, text=True, check=True).stdout.splitlines()

    return run


@pytest.mark.slow
def test_blake2s_passes_the_tests_of_its_rfc(in_c: Filter) -> None:
    """Digests of 16 to 32 bytes, with and without a key, of up to 1024 bytes."""

    def sequence(length: int, seed: int) -> bytes:  # selftest_seq of the RFC
        a, b, made = (0xDEAD4BAD * seed) & 0xFFFFFFFF, 1, bytearray()
        for _ in range(length):
            a, b = b, (a + b) & 0xFFFFFFFF
            made.append(b >> 24)
        return bytes(made)

    cases = [
        ("blake2s", size, sequence(size, size).hex() if keyed else "", sequence(length, length).hex())
        for size in (16, 20, 28, 32)
        for length in (0, 3, 64, 65, 255, 1024)
        for keyed in (False, True)
    ]
    digests = in_c(cases)
    assert hashlib.blake2s(bytes.fromhex("".join(digests))).hexdigest() == _OF_RFC_7693
    assert in_c([("blake2s", 32, "", b"abc".hex())]) == [_ABC]


def test_c_agrees_with_the_vectors(in_c: Filter) -> None:
    """Every line of signing_vectors.tsv, the same that Python and C++ are tested with."""
    text = (ROOT / "cpp/tests/signing_vectors.tsv").read_text(encoding="utf-8")
    lines = [tuple(line.split("\t")) for line in text.splitlines() if line[0] != "#"]
    assert in_c(line[:6] for line in lines) == [line[6] for line in lines]


@pytest.mark.slow
def test_c_agrees_with_python_about_random_datagrams(in_c: Filter) -> None:
    """Datagrams of all lengths: signed, changed, cut and padded ones."""
    random, last = Random(20), 37_562_400_000_000  # noqa: S311  # for values, not for secrets
    signs: list[tuple[object, ...]] = []
    verifies: list[tuple[object, ...]] = []
    signed, verdicts = [], []
    for length in range(300):
        key = Key(random.randrange(256), "x", random.randbytes(32))
        datagram = b"\x6a" + (bytes([length]) if length < 128 else bytes([length & 127 | 128, length >> 7]))
        datagram += random.randbytes(length)
        signer = Signer(23, key, SigningClock(last - 1, wall=lambda: 0, steady=lambda: 0))
        signs.append(("sign", 23, key.id, key.secret.hex(), last, datagram.hex()))
        signed.append(signer.sign(datagram))
        changed = bytearray(signed[-1])
        changed[random.randrange(len(datagram), len(changed))] ^= 1 << random.randrange(8)
        for received in (signed[-1] + bytes(length % 5), bytes(changed), signed[-1][: random.randrange(len(changed))]):
            verifies.append(("verify", 23, key.id, key.secret.hex(), last - 1, received.hex()))
            verifier = Verifier(23, [(key, last - 1, SigningClock(last - 1, wall=lambda: 0, steady=lambda: 0))])
            verdicts.append(_verdict(verifier, received))
    assert in_c(signs) == [one.hex() for one in signed]
    assert in_c(verifies) == verdicts


def _verdict(verifier: Verifier, datagram: bytes) -> str:
    try:
        verifier.verify(datagram, {"x"})
    except DatagramError as error:
        return error.reason.value
    return "accepted"
