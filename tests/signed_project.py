"""The sample rover with a basestation that must sign."""

from __future__ import annotations

import shutil
from pathlib import Path

_ROOT = Path(__file__).parents[1]
NUMBER = 22


def make_signed_project(folder: Path) -> Path:
    """Make the project in a folder, as docs/security.md says, but without `roverlink generate`; its table."""
    folder.mkdir()
    shutil.copytree(_ROOT / "proto", folder / "proto")
    shutil.copy(_ROOT / "mapping.lock", folder)
    table = (_ROOT / "mapping.yaml").read_text(encoding="utf-8")
    old = "basestation: {prefixes: [Basestation],"
    assert old in table
    table = table.replace(old, f"{old} sign: required,")
    table = table.replace("\npeers:", f"\nsigning: {{number: {NUMBER}}}\n\npeers:")
    (folder / "mapping.yaml").write_text(table, encoding="utf-8")
    return folder / "mapping.yaml"
