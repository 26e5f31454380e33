"""Datagrams of the benchmarks, built byte by byte without any contestant's library; and the protos."""

import re
import struct
from dataclasses import dataclass
from pathlib import Path

from bench.errors import BenchError

ENVELOPE = "components/common/envelope.proto"
IMPORT = re.compile(r'^import\s+(?:public\s+)?"([^"]+)"', re.MULTILINE)

FIXED32, LENGTH_DELIMITED = 5, 2  # protobuf's wire types
IMU_NUMBER = 13
IMU_FLOATS = tuple(range(1, 10))


@dataclass(frozen=True, slots=True)
class StampPlace:
    """Offsets of the stamp's two floats in a datagram."""

    high: int
    low: int


IMU_STAMP = StampPlace(high=18, low=23)  # gyro_x, gyro_y
MOTOR_STAMP = StampPlace(high=3, low=8)  # distance_to_go, turning_radius


def imu_datagram() -> bytes:
    """Return an envelope with a SensorBoardIMUInfo: 9 floats, is_calibrated and state; 51 bytes."""
    floats = b"".join(struct.pack("<Bf", number << 3 | FIXED32, 0.5 + number) for number in IMU_FLOATS)
    payload = floats + bytes((13 << 3, 1, 14 << 3, 1))
    return bytes((IMU_NUMBER << 3 | LENGTH_DELIMITED, len(payload))) + payload


def envelope_closure(root: Path) -> list[str]:
    """Return the envelope's proto and all its imports, relative to the proto root, sorted."""
    found: set[str] = set()
    open_files = [ENVELOPE]
    while open_files:
        name = open_files.pop()
        if name in found:
            continue
        try:
            text = (root / name).read_text(encoding="utf-8")
        except OSError as error:
            raise BenchError(f"{root / name}: {error.strerror}; `roverlink generate` writes the envelope") from error
        found.add(name)
        open_files += IMPORT.findall(text)
    return sorted(found)


def compile_python(protos: list[str], root: Path, out: Path) -> None:
    """Write the protos' Python modules, for the hand-written bridge."""
    from grpc_tools import protoc  # imported here: without it, the benchmarks run without that contestant

    out.mkdir(parents=True, exist_ok=True)
    if protoc.main(["protoc", f"-I{root}", f"--python_out={out}", *protos]) != 0:
        raise BenchError(f"cannot compile the protos below {root}")
