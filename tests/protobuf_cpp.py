"""C++ that protoc writes, compiled faster: each file reads all headers of protobuf, so many are read as one."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

_PRIVATE = ("schemas", "file_default_instances")
"""What protoc calls the same in each file."""


def in_one_file(made: Path, sources: Iterable[Path]) -> Path:
    """Write a source file that includes many .pb.cc files; return its path."""
    lines = []
    for number, source in enumerate(sources):
        lines += [f"#define {name} {name}_{number}" for name in _PRIVATE]
        lines += [f'#include "{source}"', *(f"#undef {name}" for name in _PRIVATE)]
    made.write_text("\n".join([*lines, ""]), encoding="utf-8")
    return made
