"""`roverlink init`: from a folder of .proto files to a bridge that carries a message."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

sys.path.append(str(Path(__file__).parents[1] / "generator"))

from trees import COLLIDING, FLAT, PACKAGES, PACKAGES_BEFORE, commit, plant

pytest.importorskip("cyclonedds", reason="Cyclone DDS has no wheel for this machine")

Start = Callable[..., Any]


def _packages(folder: Path) -> None:
    plant(folder / "protos", PACKAGES_BEFORE)
    commit(folder, "First")
    plant(folder / "protos", PACKAGES)
    commit(folder, "Take the pH sensor away")


_TREES = {
    "flat": (lambda folder: plant(folder / "protos", FLAT), "joints", "baseAngle=0.5", {"base_angle": 0.5}),
    "packages": (_packages, "imu", "accel_x=0.5", {"accel_x": 0.5}),
    "colliding": (lambda folder: plant(folder / "protos", COLLIDING), "gps", "latitude=0.5", {"latitude": 0.5}),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", _TREES)
def test_from_protos_to_a_bridge_that_carries_a_message(name: str, tmp_path: Path, start: Start, done: Start) -> None:
    """One command, and `generate`, `lint` and `run` work; a datagram that a board sends comes out on its topic."""
    prepare, row, assignment, expected = _TREES[name]
    prepare(tmp_path)  # type: ignore[operator]
    code, said, errors = done("init", "--from", "protos", folder=tmp_path)
    assert (code, errors) == (0, "")
    assert "next:\n" in said
    code, said, _ = done("generate", folder=tmp_path)
    assert (code, said.startswith("0 changes")) == (0, True)
    assert done("lint", folder=tmp_path)[0] == 0
    bridge = start("run", "--json", "--middleware", "dds", "--ros-args", "-p", "listen_port:=0", folder=tmp_path)
    port = json.loads(bridge.wait_for("port", bridge.output))["port"]
    echo = start("echo", row, "--json", "--count", 1, "--timeout", 60, folder=tmp_path)
    board = ("send", row, assignment, "--to", f"127.0.0.1:{port}", "--count", 1200, "--rate", 20)
    start(*board, folder=tmp_path)
    assert echo.end() == 0
    assert json.loads(echo.output[0]).items() >= expected.items()  # type: ignore[attr-defined]
    assert bridge.interrupt()[0] == 0


def test_a_table_is_never_overwritten(tmp_path: Path, done: Start) -> None:
    """Where there is a mapping.yaml, init says so, and leaves everything as it is."""
    plant(tmp_path / "protos", FLAT)
    (tmp_path / "mapping.yaml").write_text("version: 1\n")
    code, _, errors = done("init", "--from", "protos", folder=tmp_path)
    assert code == 2
    assert "mapping.yaml is there already" in errors
    assert {path.name for path in tmp_path.iterdir()} == {"mapping.yaml", "protos"}


def test_a_dry_run_prints_the_table(tmp_path: Path, done: Start) -> None:
    """With --dry-run, the table goes to standard output and nowhere else."""
    plant(tmp_path / "protos", FLAT)
    code, said, _ = done("init", "--from", "protos", "--dry-run", folder=tmp_path)
    assert code == 0
    assert "proto: ArmJoints" in said
    assert {path.name for path in tmp_path.iterdir()} == {"protos"}


@pytest.mark.parametrize(("given", "code"), [(("--from", "nowhere"), 2), (("--from", "broken"), 1)])
def test_what_cannot_be_taken_over_leaves_nothing(
    given: tuple[str, str], code: int, tmp_path: Path, done: Start
) -> None:
    """Exit code 2 where there is nothing to look at, 1 where protoc refuses the envelope; nothing is written."""
    plant(tmp_path / "broken", {"messages.proto": FLAT["messages.proto"].replace("sint32", "sint33")})
    ended, _, errors = done("init", *given, folder=tmp_path)
    assert ended == code
    assert "nothing was written" in errors
    assert {path.name for path in tmp_path.iterdir()} == {"broken"}
