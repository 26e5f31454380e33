"""The frames of serial lines in C, for firmware: beside PyPI's COBS with binascii's CRC, and beside Python's frames."""

from __future__ import annotations

import binascii
import shutil
import subprocess
from collections.abc import Callable, Iterable
from pathlib import Path
from random import Random

import pytest

from roverlink.runtime.net.transports.framing import FrameReader, encode_frame

cobs = pytest.importorskip("cobs.cobs", reason="need COBS of others (pip install cobs)")

ROOT = Path(__file__).parents[2]
_LARGEST = 2000

Filter = Callable[[Iterable[str]], list[str]]


@pytest.fixture(scope="module")
def in_c(tmp_path_factory: pytest.TempPathFactory) -> Filter:
    """Function that lets the C code work on lines: `write DATAGRAM` and `read CAPACITY BYTES`."""
    if shutil.which("gcc") is None:
        pytest.skip("need a C compiler (apt-get install gcc)")
    program = tmp_path_factory.mktemp("c") / "filter"
    warnings = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wsign-conversion", "-Wshadow", "-Werror"]
    checks = ["-O1", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"]
    sources = [str(Path(__file__).with_name("framing_filter.c")), str(ROOT / "cpp/c/roverlink_framing.c")]
    command = ["gcc", "-std=c99", *warnings, *checks, f"-I{ROOT / 'cpp/c'}", *sources, "-o", str(program)]
    subprocess.run(command, check=True)

    def run(lines: Iterable[str]) -> list[str]:
        text = "".join(f"{line}\n" for line in lines)
        return subprocess.run([program], input=text, capture_output=True, text=True, check=True).stdout.splitlines()

    return run


def _datagrams(random: Random) -> list[bytes]:
    """Datagrams of all lengths at which COBS begins a block, with no zero, few and many zeros."""
    lengths = [*range(12), *range(248, 260), *range(502, 514), 760, 1472, _LARGEST]
    return [bytes(random.choices(range(low, 4), k=length)) for length in lengths for low in (0, 1)] + [
        random.randbytes(length) for length in lengths
    ]


def test_frames_in_c_are_those_of_others(in_c: Filter) -> None:
    """C writes the bytes that PyPI's COBS and binascii's CRC give, and the CRC is that of the catalogues."""
    datagrams = [b"123456789", *_datagrams(Random(1))]  # noqa: S311  # for values, not for secrets
    checked = [one + binascii.crc_hqx(one, 0xFFFF).to_bytes(2, "big") for one in datagrams]
    assert checked[0].endswith(b"\x29\xb1")
    assert in_c(f"write {one.hex()}" for one in datagrams) == [(cobs.encode(one) + b"\0").hex() for one in checked]


def test_c_and_python_read_each_other(in_c: Filter) -> None:
    """Frames of C arrive whole in Python, those of Python in C; a buffer that is a byte too small refuses."""
    datagrams = _datagrams(Random(2))  # noqa: S311  # for values, not for secrets
    from_c = [bytes.fromhex(line) for line in in_c(f"write {one.hex()}" for one in datagrams)]
    assert FrameReader(_LARGEST).take(b"\0" + b"\0".join(from_c)) == datagrams
    lines = [f"read {len(one) + room} {encode_frame(one).hex()}" for one in datagrams for room in (1, 2)]
    assert in_c(lines) == [read for one in datagrams for read in ("1", f"{one.hex()},0")]


def test_c_and_python_judge_a_noisy_line_alike(in_c: Filter) -> None:
    """Of frames with lost, changed and inserted bytes, both take the same datagrams, refuse as many, and catch up."""
    random = Random(3)  # noqa: S311  # for values, not for secrets
    lines, expected = [], []
    for _ in range(300):
        stream = bytearray()
        for _ in range(20):
            frame = bytearray(encode_frame(random.randbytes(random.randrange(40))))
            for _ in range(random.choice((0, 0, 1, 3))):
                start = random.randrange(len(frame))
                frame[start : start + random.randrange(3)] = random.choices((0, 1, 2, 255, 77), k=random.randrange(3))
            stream += frame
        stream += b"\0" + encode_frame(b"last")
        reader = FrameReader(_LARGEST)
        taken = reader.take(bytes(stream))
        assert taken[-1] == b"last"
        lines.append(f"read {_LARGEST + 2} {stream.hex()}")
        expected.append("".join(f"{one.hex()}," for one in taken) + str(reader.refused))
    assert in_c(lines) == expected
