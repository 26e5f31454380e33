"""Programs of boards: C that nanopb's own generator makes of protos, with the options that our target writes."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path

import pytest
from needs import HAS_NANOPB, NO_NANOPB


def compiled(folder: Path, root: Path, options: Path, protos: Iterable[str], program: str, *defines: str) -> Path:
    """Compile a program of this folder in another folder, with the protos below ``root``; return its path."""
    if not HAS_NANOPB:
        pytest.skip(NO_NANOPB)
    made, board = folder / "firmware", folder / "board"
    made.mkdir()
    generator = [sys.executable, "-m", "nanopb.generator.nanopb_generator", "--quiet", "--options-path", str(options)]
    environment = {**os.environ, "PROTOCOL_BUFFERS_PYTHON_IMPLEMENTATION": "upb"}
    command = [*generator, "-I", str(root), "-D", str(made), *sorted(protos)]
    subprocess.run(command, check=True, cwd=root, env=environment)
    sources = [Path(__file__).with_name(program), *sorted(made.rglob("*.pb.c")), *sorted(options.glob("*.c"))]
    flags = ["-std=c11", "-Wall", "-Wextra", "-Werror", "-O1", f"-I{made}", f"-I{options}", *defines]
    subprocess.run(["gcc", *flags, *map(str, sources), "-o", str(board), "-lprotobuf-nanopb"], check=True)
    return board
