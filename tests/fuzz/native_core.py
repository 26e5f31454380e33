"""Fuzz the native core with libFuzzer, AddressSanitizer and UndefinedBehaviorSanitizer.

``python tests/fuzz/native_core.py to_cdr -max_total_time=60``: the door ``to_cdr`` takes payloads, ``to_proto`` takes
serialized ROS 2 messages, ``receive`` takes datagrams with and without a signature; what follows goes to libFuzzer.
There is a run with the table of the sample rover, which begins with messages of a simulated rover and with random ones,
and one with the table of the wire cases, which begins with these. Needs clang.
"""

from __future__ import annotations

import contextlib
import ctypes
import os
import runpy
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from random import Random

_ROOT = Path(__file__).parents[2]
sys.path[:0] = [str(_ROOT), str(_ROOT / "tests")]

from google.protobuf.message import DecodeError  # noqa: E402  # not on the path of a script
from native_wire_cases import ACCEPTED, HANDED_OVER, OTHERS, wire_project  # noqa: E402
from payloads import random_payload  # noqa: E402

from generated.registry import REGISTRY  # noqa: E402
from roverlink.generator.example_payloads import payload_at  # noqa: E402
from roverlink.runtime import ConversionError, Registry  # noqa: E402
from roverlink.runtime.core.envelope import strip_trailing_zeros  # noqa: E402
from roverlink.runtime.core.signing import Key, Signer, SigningClock  # noqa: E402
from roverlink.runtime.core.wire_format import DELIMITED, encoded_varint  # noqa: E402
from roverlink.runtime.native.core import open_core  # noqa: E402

_DOORS = ("to_cdr", "to_proto", "receive")
_SIGNER = Signer(23, Key(1, "peer", bytes(32)), SigningClock())
_FLAGS = (
    "-std=c++17 -O1 -g -ffp-contract=off -DRL_GUARD_WORKSPACE "
    "-fsanitize=fuzzer,address,undefined -fno-sanitize-recover=undefined"
)


def main(door: str, options: list[str]) -> int:
    """Fuzz until a fault is found, or as long as libFuzzer was told. Return its exit code."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        program = folder / "native_core"
        sources = [*sorted(_ROOT.glob("native/src/*.cpp")), Path(__file__).with_suffix(".cpp")]
        includes = [f"-I{_ROOT / one}" for one in runpy.run_path(str(_ROOT / "hatch_build.py"))["INCLUDES"]]
        subprocess.run(["clang++", *_FLAGS.split(), *includes, *sources, "-o", program], check=True)
        (folder / "wire").mkdir()
        wire_cases = [*ACCEPTED.values(), *HANDED_OVER.values(), *OTHERS.values()]
        for registry, payloads in ((REGISTRY, []), (wire_project(folder / "wire"), wire_cases)):
            corpus, table = folder / f"corpus of {registry.package}", folder / "table"
            corpus.mkdir()
            for number, data in enumerate(_inputs(registry, payloads, door)):
                (corpus / str(number)).write_bytes(data)
            table.write_bytes(_table(registry))
            variables = {**os.environ, "ROVERLINK_FUZZ_TABLE": str(table), "ROVERLINK_FUZZ_DOOR": door}
            if code := subprocess.run([program, corpus, *options], env=variables).returncode:
                return code
    return 0


def _inputs(registry: Registry, payloads: list[bytes], door: str) -> Iterator[bytes]:
    """Yield payloads or messages of each row and extra topic, each behind the index of its translation."""
    random = Random(1)  # noqa: S311  # the same numbers each time
    for index, handler in enumerate((*registry.handlers, *registry.extra_topics)):
        found = [payload_at(handler.payload_type, second) for second in (0.0, 1.0)]
        if not payloads:
            found += [random_payload(handler.payload_type, random) for _ in range(5)]
        for payload in (*(one.SerializePartialToString() for one in found), *payloads):
            if door == "receive":
                for datagram in _datagrams(payload):
                    yield bytes([index]) + datagram
                continue
            if door == "to_cdr":
                yield bytes([index]) + payload
                continue
            with contextlib.suppress(ConversionError, DecodeError):  # there is no such message
                yield bytes([index]) + handler.to_cdr(handler.payload_type.FromString(payload))


def _datagrams(payload: bytes) -> Iterator[bytes]:
    """Yield a payload in an envelope, without and with a signature, and each with zeros stripped and appended."""
    plain, other = (encoded_varint(n << 3 | DELIMITED) + encoded_varint(len(payload)) + payload for n in (1, 2))
    for whole in (plain, _SIGNER.sign(other)):
        yield from (whole, strip_trailing_zeros(whole), whole + bytes(3))


def _table(registry: Registry) -> bytes:
    """Return the arrays of a table, each with its count and its size in bytes."""
    table, data = open_core(registry).table, b""
    for name, _ in table._fields_[:8]:
        pointer, count = getattr(table, name), getattr(table, f"n_{name}")
        size = count * ctypes.sizeof(pointer._type_)
        data += count.to_bytes(4, "little") + size.to_bytes(4, "little") + ctypes.string_at(pointer, size)
    return data


if __name__ == "__main__":
    if len(sys.argv) < 2 or sys.argv[1] not in _DOORS:
        sys.exit(f"say which door: {', '.join(_DOORS)}")
    if shutil.which("clang++") is None:
        sys.exit("missing: clang++; on Debian and Ubuntu: apt-get install clang")
    sys.exit(main(sys.argv[1], sys.argv[2:]))
