"""Do a project's C++ handlers do what its Python handlers do? A script, run as ``crosscheck.py mapping.yaml``.

It has a process of its own for the reasons of `tests/generator/crosscheck.py`.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from building import build
from comparing import Speaker, compare

from roverlink.generator.emit.writer import compare as changes
from roverlink.generator.emit.writer import write
from roverlink.generator.ir.model import Bridge, ConversionKind
from roverlink.generator.pipeline import compile_table
from roverlink.runtime import load_registry


def check(table: Path) -> None:
    """Raise `AssertionError` where the two differ."""
    compiled = compile_table(table, ["cpp"])
    write(table.parent, changes(table.parent, compiled.files, compiled.folders))
    registry = load_registry(table.parent)
    in_any = sorted({member.proto for conversion in compiled.bridge.anys for member in conversion.members})
    jazzy = "distro: jazzy" in table.read_text(encoding="utf-8")
    with tempfile.TemporaryDirectory() as folder:
        program = build(compiled.bridge, compiled.files, table.parent / "proto", Path(folder), jazzy=jazzy)
        speaker = Speaker(program)
        answers = compare(speaker, registry, in_any, examples=40, json_fields=_json_fields(compiled.bridge))
        speaker.close()
    print(f"{answers} answers are the same")


def _json_fields(bridge: Bridge) -> set[tuple[str, str]]:
    """List the ROS fields that hold JSON: the names of message and field."""
    fields = [(conversion.ros, field) for conversion in bridge.conversions().values() for field in conversion.fields]
    fields += [(field.ros.type.name, field.entry.value) for _, field in fields if field.entry]
    return {(ros, field.ros.name) for ros, field in fields if field.kind is ConversionKind.JSON}


if __name__ == "__main__":
    check(Path(sys.argv[1]).resolve())
