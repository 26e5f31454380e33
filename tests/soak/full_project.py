"""Write the sample rover with everything switched on into a folder, for `make soak`."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path
from typing import Any

import yaml

from roverlink.generator.pipeline import compile_table

_ROOT = Path(__file__).parents[2]
_HERE = "127.0.0.1"  # simulated peers send from here

# Two boards at one address that is learned; a board with hosts of its own, which need not sign; and the basestation.
_PEERS = {
    "hardware": {
        "prefixes": ["SensorBoard", "ArmBoard"],
        "host": "learn",
        "port": 6001,
        "sources": [_HERE],
        "sign": "required",
        "max_size": 1472,
        "strip_trailing_zeros": True,
    },
    "driving": {
        "prefixes": ["DrivingBoard"],
        "boards": {"DrivingBoard": {"host": ["10.0.0.22", "10.0.0.23"], "port": 6002}},
        "sources": [_HERE],
        "max_size": 1472,
    },
    "basestation": {
        "prefixes": ["Basestation"],
        "host": "10.0.1.7",
        "port": 6000,
        "sources": [_HERE],
        "source_rate": 20_000,
        "sign": "required",
        "max_size": 1472,
    },
}


def full_table() -> dict[str, Any]:
    """Return the table of the repository with signatures, link messages, boards, and guards of all rows."""
    table: dict[str, Any] = yaml.safe_load((_ROOT / "mapping.yaml").read_text(encoding="utf-8"))
    free = max(row["number"] for row in table["messages"]) + 1
    table |= {"peers": _PEERS, "signing": {"number": free}, "link": {"number": free + 1}}
    for row in table["messages"]:
        row["expect_rate"] = 1
        if row["proto"].startswith("DrivingBoard"):
            row["direction"] = row["direction"].replace("hardware", "driving")
        if row["direction"].startswith("ros_to") and "also" not in row:  # the lint refuses both (SAF101)
            row.setdefault("deadman", {"after": "500ms", "send": {}})
        if row["name"] in ("sensor_diag", "arm_target"):
            row["max_rate"] = 10
    return table


def write_project(folder: Path) -> None:
    """Replace the project in a folder, with its generated files."""
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(_ROOT / "proto", folder / "proto")
    (folder / "mapping.yaml").write_text(yaml.safe_dump(full_table(), sort_keys=False), encoding="utf-8")
    for path, text in compile_table(folder / "mapping.yaml").files.items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    write_project(Path(sys.argv[1]))
