"""Build of the C++ programs, with packages of Debian or Ubuntu."""

import hashlib
import os
import shutil
import subprocess
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from bench.errors import BenchError

HERE = Path(__file__).parent
FLAGS = ("-std=c++17", "-O2", "-pthread")
TOOLS = {"g++": "g++", "pkg-config": "pkg-config", "protoc": "protobuf-compiler", "idlc": "cyclonedds-tools"}
LIBRARIES = {"protobuf": "libprotobuf-dev", "CycloneDDS": "cyclonedds-dev"}


@dataclass(frozen=True, slots=True)
class Programs:
    """Paths of the built programs."""

    reference: Path
    load: Path
    observe: Path


def missing_packages() -> list[str]:
    """Return the apt packages that are missing for the build."""
    missing = [package for tool, package in TOOLS.items() if shutil.which(tool) is None]
    if "pkg-config" in missing:
        return missing + list(LIBRARIES.values())
    return missing + [package for library, package in LIBRARIES.items() if _run("pkg-config", "--exists", library)]


def build(protos: Sequence[str], root: Path, out: Path) -> Programs:
    """Build the programs into `out`, unless they exist already, made from the same sources."""
    programs = Programs(reference=out / "reference", load=out / "load", observe=out / "observe")
    ours = sorted(source for source in HERE.iterdir() if source.suffix in {".cpp", ".hpp", ".idl"})
    sources = [*ours, *(root / proto for proto in protos)]
    fingerprint, stamp = _fingerprint(sources), out / "fingerprint"
    if stamp.exists() and stamp.read_text(encoding="ascii") == fingerprint:
        return programs
    shutil.rmtree(out, ignore_errors=True)
    out.mkdir(parents=True)
    _compile(programs, protos, root, out)
    stamp.write_text(fingerprint, encoding="ascii")
    return programs


def _compile(programs: Programs, protos: Sequence[str], root: Path, out: Path) -> None:
    _check("idlc", "-t", "-o", str(out), str(HERE / "messages.idl"))
    _check("protoc", f"-I{root}", f"--cpp_out={out}", *protos)
    includes = (f"-I{out}", f"-I{HERE}")
    messages = str(out / "messages.o")
    _check("g++", "-O2", *includes, "-x", "c", "-c", str(out / "messages.c"), "-o", messages)
    for program in (programs.load, programs.observe):
        _check("g++", *FLAGS, *includes, str(HERE / f"{program.name}.cpp"), messages, "-lddsc", "-o", str(program))
    with ThreadPoolExecutor(os.cpu_count()) as compilers:  # one after the other they take most of the build's time
        parsers = list(compilers.map(partial(_compile_parser, out), protos))
    libraries = ("-lddsc", "-lprotobuf")
    reference = str(HERE / "reference.cpp")
    _check("g++", *FLAGS, *includes, reference, *parsers, messages, *libraries, "-o", str(programs.reference))


def _compile_parser(out: Path, proto: str) -> str:
    """The object file of what protoc wrote for a proto."""
    source = (out / proto).with_suffix(".pb.cc")
    compiled = str(source.with_suffix(".o"))
    _check("g++", *FLAGS, f"-I{out}", "-c", str(source), "-o", compiled)
    return compiled


def _fingerprint(sources: Iterable[Path]) -> str:
    digest = hashlib.sha256()
    for source in sources:
        digest.update(source.read_bytes())
    return digest.hexdigest()


def _run(*command: str) -> str:
    """Return the error text of a command, or "" if it succeeded."""
    # Locale C: the compiler's messages are in English.
    environment = {**os.environ, "LC_ALL": "C"}
    result = subprocess.run(  # noqa: S603  # compilers, by name
        command, capture_output=True, text=True, env=environment, check=False
    )
    return "" if result.returncode == 0 else result.stderr.strip() or f"{command[0]}: status {result.returncode}"


def _check(*command: str) -> None:
    if complaint := _run(*command):
        raise BenchError(f"cannot build the C++ programs: {complaint.splitlines()[0]}")
