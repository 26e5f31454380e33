"""`roverlink init`: from nothing, or from a folder of .proto files, to a bridge that carries a message."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import yaml
from needs import NO_DDS
from programs import Start
from running import Bridge, Called

sys.path.append(str(Path(__file__).parents[1] / "generator"))

from trees import COLLIDING, FLAT, PACKAGES, PACKAGES_BEFORE, commit, plant

pytest.importorskip("cyclonedds", reason=NO_DDS)


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
def test_from_protos_to_a_bridge_that_carries_a_message(
    name: str, tmp_path: Path, start: Start, called: Called, bridge: Bridge
) -> None:
    """One command, and `generate`, `lint` and `run` work; a datagram that a board sends comes out on its topic."""
    prepare, row, assignment, expected = _TREES[name]
    prepare(tmp_path)  # type: ignore[operator]
    code, said, errors = called("init", "--from", "protos", folder=tmp_path)
    assert (code, errors) == (0, "")
    assert "next:\n" in said
    code, said, _ = called("generate", folder=tmp_path)
    assert (code, said.startswith("0 changes")) == (0, True)
    assert called("lint", folder=tmp_path)[0] == 0
    program, port = bridge(middleware="dds", folder=tmp_path)
    echo = start("echo", row, "--json", "--count", 1, "--timeout", 60, folder=tmp_path)
    board = ("send", row, assignment, "--to", f"127.0.0.1:{port}", "--count", 1200, "--rate", 20)
    start(*board, folder=tmp_path)
    assert echo.end() == 0
    assert json.loads(echo.output[0]).items() >= expected.items()  # type: ignore[attr-defined]
    assert program.interrupt() == 0


def _git(folder: Path, *arguments: str) -> None:
    people = {f"GIT_{who}_{what}": "a@example.com" for who in ("AUTHOR", "COMMITTER") for what in ("NAME", "EMAIL")}
    subprocess.run(["git", "-C", folder, *arguments], env={**os.environ, **people}, check=True, capture_output=True)


def _repository(folder: Path, branch: str, *, cloned: bool = False, submodule: bool = False) -> None:
    """Commit a tree of protos, in the folder itself or in a submodule of it, or clone it into the folder."""
    protos = {name.removeprefix("protos/"): text for name, text in _FLAT.items()}
    origin = folder.parent / "origin" if cloned or submodule else folder
    plant(origin if submodule else origin / "protos", protos)
    _git(origin.parent, "init", "--quiet", "--initial-branch", branch, str(origin))
    _git(origin, "add", "--all")
    _git(origin, "commit", "--quiet", "--message", "Begin")
    if cloned:
        _git(folder.parent, "clone", "--quiet", str(origin), str(folder))
    elif submodule:
        _git(folder.parent, "init", "--quiet", "--initial-branch", branch, str(folder))
        _git(folder, "-c", "protocol.file.allow=always", "submodule", "add", str(origin), "protos")
        _git(folder, "commit", "--quiet", "--message", "Begin")


_PLACES: dict[str, tuple[dict[str, Any], str]] = {
    "a clone of main": ({"branch": "main", "cloned": True}, "origin/main"),
    "a clone of dev": ({"branch": "dev", "cloned": True}, "origin/dev"),
    "no remote, master": ({"branch": "master"}, "master"),
    "a submodule, trunk": ({"branch": "trunk", "submodule": True}, "trunk"),
}


@pytest.mark.slow
@pytest.mark.parametrize("place", _PLACES)
def test_the_printed_commands_run_in_this_tree(place: str, tmp_path: Path, called: Called) -> None:
    """Each command but the bridge ends with 0; the one for CI names the branch that is here; CI's files are there."""
    settings, base = _PLACES[place]
    folder = tmp_path / "rover"
    _repository(folder, **settings)
    code, said, _ = called("init", "--from", "protos", folder=folder)
    assert code == 0
    commands = [re.split("  +", line.strip())[0] for line in said.partition("next:\n")[2].splitlines()[1:]]
    assert commands == [
        "roverlink generate",
        "roverlink lint",
        "roverlink run",
        f"roverlink lint --against {base} --history",
    ]
    assert [called(*one.split()[1:], folder=folder)[0] for one in commands if one != "roverlink run"] == [0, 0, 0]
    workflow = yaml.safe_load((folder / ".github" / "workflows" / "roverlink.yml").read_text())
    assert workflow[True]["push"]["branches"] == [base.rpartition("/")[2]]  # YAML 1.1 reads `on` as true
    (hook,) = yaml.safe_load((folder / ".pre-commit-config.yaml").read_text())["repos"][0]["hooks"]
    assert called(*hook["entry"].split()[1:], folder=folder)[0] == 0


_FLAT = {f"protos/{name}": text for name, text in FLAT.items()}
_STARTED = {
    *(".github", ".gitignore", ".pre-commit-config.yaml", "docs", "generated", "mapping.lock", "mapping.yaml"),
    "proto",
}


@pytest.mark.slow
def test_an_empty_folder_becomes_a_project_that_runs(tmp_path: Path, done: Start, bridge: Bridge) -> None:
    """One command, and `generate --check` and `lint` are clean, and the bridge takes what the board sends."""
    code, said, errors = done("init", folder=tmp_path)
    assert (code, errors) == (0, "")
    assert {path.name for path in tmp_path.iterdir()} == _STARTED
    steps = [line.split("  ")[1] for line in said.partition("next:\n")[2].splitlines()]
    assert steps == ["roverlink run", "roverlink echo board_status", "roverlink send board_status battery_voltage=11.7"]
    assert done("generate", "--check", folder=tmp_path)[0] == 0
    assert done("lint", folder=tmp_path)[0] == 0
    program, port = bridge("--json", folder=tmp_path)
    send = steps[2].split()[1:]
    assert done(*send, "--to", f"127.0.0.1:{port}", folder=tmp_path)[0] == 0
    assert program.interrupt() == 0
    account = json.loads(program.output[-1])
    assert (account["received"], account["published"], account["dropped"]) == (1, 1, {})


_BOARD = 'syntax = "proto3";\n\nmessage BoardStatus {\n  float voltage = 1;\n}\n'


def test_files_that_are_there_stay_as_they_are(tmp_path: Path, called: Called) -> None:
    """What a user wrote is named and left alone; below the top of a repository the way of two files is told."""
    subprocess.run(["git", "init", "--quiet", tmp_path], check=True)
    folder = tmp_path / "software" / "rover"
    plant(folder, {".gitignore": "*.bag\n", "proto/board.proto": _BOARD})
    code, said, _ = called("init", folder=folder)
    assert code == 0
    assert "kept the existing proto/board.proto\nkept the existing .gitignore\n" in said
    assert f"move them to {tmp_path}\n" in said
    files = [path for path in (folder / "generated").rglob("*") if path.is_file()]
    assert f" and {len(files)} files in generated/\n" in said
    assert (folder / ".gitignore").read_text() == "*.bag\n"
    assert (folder / "proto" / "board.proto").read_text() == _BOARD
    assert "voltage" in (folder / "generated" / "ros" / "comms" / "msg" / "BoardStatus.msg").read_text()


@pytest.mark.parametrize(
    ("there", "options", "code", "expected"),
    [
        ({"mapping.yaml": "version: 1\n"}, "", 2, ["mapping.yaml exists already"]),
        (
            {"docs/messages.md": "Ours.\n"},
            "",
            2,
            ["docs/messages.md: fatal[ADO103] the file exists and was not generated"],
        ),
        ({"proto/arm.proto": _BOARD}, "", 2, ["fatal[ADO104]", "use `roverlink init --from proto`"]),
        ({"proto/board.proto": "message B {}"}, "", 2, ["proto/board.proto: fatal[ADO104] the file exists already"]),
        ({}, "--message Envelope", 2, ["--from"]),
        ({"mapping.yaml": "version: 1\n", **_FLAT}, "--from protos", 2, ["mapping.yaml exists already"]),
        ({}, "--from nowhere", 2, ["nothing was written"]),
        (
            {"protos/messages.proto": FLAT["messages.proto"].replace("sint32", "sint33")},
            "--from protos",
            1,
            ["nothing was written"],
        ),
        (_FLAT, "--from protos --dry-run", 0, ["proto: ArmJoints"]),
        ({}, "--dry-run", 0, ["proto: BoardStatus"]),
    ],
)
def test_nothing_is_written_where_something_is_in_the_way(
    there: dict[str, str], options: str, code: int, expected: list[str], tmp_path: Path, called: Called
) -> None:
    """Files in the way, nothing to look at, or a wrong option: exit code 2; what protoc refuses: 1; a dry run: 0."""
    plant(tmp_path, there)
    ended, output, errors = called("init", *options.split(), folder=tmp_path)
    assert ended == code
    assert all(text in (errors if code else output) for text in expected)
    assert {path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("*") if path.is_file()} == {*there}
