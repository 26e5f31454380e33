"""The other state of `roverlink lint --against`: git refs, folders, descriptor sets, and all that is none of them."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from repositories import RepositoryBuilder, git

_ENVELOPE = """\
syntax = "proto3";

import "imu.proto";

message Envelope {
  oneof payload {
    Imu imu = 1;
    Gps gps = 2;
  }
}
"""
_IMU = """\
syntax = "proto3";

message Imu {
  float accel_x = 1;
  float accel_y = 2;
}

message Gps {
  double latitude = 1;
}
"""
_TREE = ("--envelope", "envelope.proto", "--message", "Envelope")
_MAIN = ("--against", "main", *_TREE)
_DELETED = ("imu.proto", "  float accel_y = 2;\n", "")

Run = Callable[..., tuple[int, str, str]]
Found = Callable[..., tuple[int, list[dict[str, Any]]]]
Edit = tuple[str, str, str]


@pytest.fixture
def tree(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A tree of protos without a table, committed to a repository of its own; the current folder is above it."""
    monkeypatch.chdir(tmp_path)
    for name in ("GIT_DIR", "GIT_WORK_TREE", "GIT_INDEX_FILE"):
        monkeypatch.delenv(name, raising=False)
    return RepositoryBuilder(tmp_path / "protos").commits({"envelope.proto": _ENVELOPE, "imu.proto": _IMU}).write()


def _commit(root: Path) -> None:
    git(root, "add", "--all")
    git(root, "-c", "user.name=A", "-c", "user.email=a@example.com", "commit", "--quiet", "--message", "Change")


def _replace(tree: Path, name: str, before: str, after: str) -> None:
    text = (tree / name).read_text()
    assert before in text
    (tree / name).write_text(text.replace(before, after))


def _said(found: list[dict[str, Any]], *keys: str) -> list[tuple[Any, ...]]:
    return [tuple(one[key] for key in keys) for one in found]


# --- the three kinds of states ---


@pytest.mark.slow
def test_a_change_is_found_against_every_kind_of_state(tree: Path, run: Run, found: Found) -> None:
    """A number that was given to another payload is found at its place, whatever the other state comes from.

    Where it is a ref, a finding says with which commit the first use came: id, date, subject.
    """
    assert run("lint", "protos", *_MAIN) == (0, "No problems found.\n", "")
    shutil.copytree(tree, "old", ignore=shutil.ignore_patterns(".git"))
    command = [sys.executable, "-m", "grpc_tools.protoc", "-Iold", "--descriptor_set_out=old.binpb"]
    subprocess.run([*command, "--include_imports", "envelope.proto"], check=True)
    _replace(tree, "envelope.proto", "Gps gps = 2", "Imu backup_imu = 2")
    for state in ("main", "old", "old.binpb"):
        code, all = found("protos", "--against", state, *_TREE)
        reuses = [one for one in all if one["id"] == "ENV102"]
        assert (code, _said(reuses, "path", "line", "number")) == (1, [("envelope.proto", 8, 2)])
    id = git(tree, "rev-parse", "--short=10", "main").strip()
    assert f"main:envelope.proto:8:5: published here ({id} 2026-02-03 0)" in run("lint", "protos", *_MAIN)[1]


def test_a_ref_sees_the_folder_it_is_asked_for(tree: Path, found: Found) -> None:
    """A tree that is a folder within the repository is compared with that folder, and with nothing beside it."""
    (tree / "sub").mkdir()
    for name in ("envelope.proto", "imu.proto"):
        (tree / name).rename(tree / "sub" / name)
    (tree / "broken.proto").write_text("message {")
    _commit(tree)
    _replace(tree / "sub", *_DELETED)
    code, all = found(tree / "sub", *_MAIN)
    assert (code, set(_said(all, "path", "message_type"))) == (1, {("imu.proto", "Imu")})


def test_the_repository_is_that_of_the_folder(tree: Path, found: Found, monkeypatch: pytest.MonkeyPatch) -> None:
    """In a hook, git says which repository it runs in; what is looked at may stand in another one."""
    other = RepositoryBuilder(tree.parent / "other").commits({}).write()
    _replace(tree, *_DELETED)
    monkeypatch.setenv("GIT_DIR", str(other / ".git"))
    monkeypatch.setenv("GIT_WORK_TREE", str(other))
    code, (one,) = found("protos", *_MAIN)
    assert (code, one["id"], one["also"][0]["commit"]["subject"]) == (1, "WIR102", "0")


# --- protos in a submodule ---

_TABLE = """\
version: 1
proto: {root: protos}
envelope: {file: envelope.proto, message: Envelope, oneof: payload, owner: proto}
ros: {package: probe}
peers: {board: {}}
messages:
  - {number: 1, name: imu, proto: Imu, topic: imu, direction: board_to_ros}
  - {number: 2, name: gps, proto: Gps, topic: gps, direction: board_to_ros}
"""


@pytest.fixture
def rover(tree: Path) -> Path:
    """A project in a folder of a repository, with `tree` as a submodule; the current folder is the project's."""
    project = RepositoryBuilder(tree.parent / "rover").commits({"README.md": ""}).write() / "software"
    project.mkdir()
    git(project, "-c", "protocol.file.allow=always", "submodule", "--quiet", "add", str(tree), "protos")
    (project / "mapping.yaml").write_text(_TABLE)
    _commit(project)
    os.chdir(project)
    return project


@pytest.mark.slow
def test_the_state_has_the_commit_that_it_pins(rover: Path, found: Found, run: Run) -> None:
    """A change in the submodule is found at its place, and the commit of the line before is one of the submodule's."""
    assert run("lint", "--against", "main", "--history") == (0, "No problems found.\n", "")
    _replace(rover / "protos", *_DELETED)
    _commit(rover / "protos")
    code, (one,) = found("--against", "main", "--history")
    assert (code, one["id"], one["path"]) == (1, "WIR102", "protos/imu.proto")
    (before,) = one["also"]
    assert (before["path"], before["commit"]["subject"]) == ("main:software/protos/imu.proto", "0")
    git(rover, "mv", "protos", "moved")
    (rover / "mapping.yaml").write_text(_TABLE.replace("root: protos", "root: moved"))
    assert found("--against", "main")[1][0]["path"] == "moved/imu.proto"
    _commit(rover)
    git(rover, "tag", "later")  # a ref that the submodule's repository does not have
    assert [one["id"] for one in found("--history", "later", "--against", "main~1")[1]] == ["WIR102"]


@pytest.mark.slow
def test_a_state_whose_submodule_is_not_here_is_one_line(rover: Path, found: Found, run: Run) -> None:
    """The line names the submodule and its commit; a state from before the project is nothing to compare with."""
    pinned = "1" * 40
    git(rover, "update-index", "--cacheinfo", f"160000,{pinned},software/protos")
    git(rover, "-c", "user.name=A", "-c", "user.email=a@example.com", "commit", "--quiet", "--message", "Pin")
    code, (one,) = found("--against", "HEAD")
    assert (code, one["id"], one["path"]) == (2, "STA102", "HEAD:software/protos")
    assert one["message"] == "the submodule's commit 1111111111 is not in this clone"
    assert f"`git -C protos fetch origin {pinned}`" in one["help"]
    code, (one,) = found("--against", "main~2")
    message = "the earlier state has no .proto file, so nothing was compared"
    assert (code, one["severity"], one["message"]) == (0, "hint", message)


# --- bad input ---


@pytest.mark.parametrize(
    ("state", "said"),
    [
        ("mian", "fatal[STA101] 'mian' is not a folder, a file, or a git ref"),
        ("--help", "fatal[STA101] '--help' is not"),  # it is not handed to git as an option
        ("empty.binpb", "empty.binpb: fatal[STA102] the descriptor set contains no .proto file"),
        ("odd.binpb", "odd.binpb: fatal[STA102] the file is not a descriptor set"),
        ("empty", "empty: fatal[STA102] the earlier state contains no .proto file"),
    ],
)
def test_no_such_state(tree: Path, run: Run, state: str, said: str) -> None:
    """What is no folder, no descriptor set and no ref, or is empty, is said with exit code 2."""
    Path("empty").mkdir()
    Path("empty.binpb").write_bytes(b"")
    Path("odd.binpb").write_bytes(b"\xff\xff\xff")
    code, out, err = run("lint", "protos", f"--against={state}", *_TREE)
    assert (code, said in out, err) == (2, True, "")


def test_an_envelope_that_does_not_compile(tree: Path, run: Run) -> None:
    """Where the envelope is missing, it is said why: its file has an error."""
    _replace(tree, "envelope.proto", "Gps gps = 2;", "Gps gps = 2")
    code, out, _ = run("lint", "protos", *_TREE)
    assert code == 2
    assert 'envelope.proto:9:3: error[PRO101] Expected ";"' in out
    assert "fatal[STA104] the message 'Envelope' is declared in envelope.proto, which does not compile" in out
    assert "  help: correct the errors in envelope.proto\n" in out


@pytest.mark.slow
def test_an_envelope_named_without_its_package(tree: Path, run: Run, found: Found) -> None:
    """The last part of its name is enough, as long as there is one such message.

    What is to be written compiles: a name that another number has now cannot be reserved.
    """
    for name in ("envelope.proto", "imu.proto"):
        _replace(tree, name, 'syntax = "proto3";\n', 'syntax = "proto3";\n\npackage rover;\n')
    _commit(tree)
    _replace(tree, "envelope.proto", "Gps gps = 2;", "Gps gps = 3;")
    code, all = found("protos", *_MAIN)
    assert (code, _said(all, "id", "message_type", "help")) == (
        1,
        [("ENV107", "rover.Envelope", "add `reserved 2;` to the message 'rover.Envelope'")],
    )
    (tree / "other.proto").write_text('syntax = "proto3";\n\npackage other;\n\nmessage Envelope {}\n')
    code, out, _ = run("lint", "protos", *_TREE)
    assert (code, "help: use --message rover.Envelope or --message other.Envelope" in out) == (2, True)


@pytest.mark.slow
def test_a_state_that_does_not_compile(tree: Path, found: Found) -> None:
    """A file that does not compile is named, in the other state as a hint; the rest is compared all the same."""
    (tree / "broken.proto").write_text('syntax = "proto3";\n\nmessage Broken {\n  Missing x = 1;\n}\n')
    _commit(tree)
    (tree / "broken.proto").unlink()
    _replace(tree, *_DELETED)
    code, all = found("protos", *_MAIN)
    assert (code, _said(all, "id", "severity", "path")) == (
        1,
        [("WIR102", "error", "imu.proto"), ("STA102", "hint", "main:broken.proto")],
    )
    _commit(tree)
    _replace(tree, "imu.proto", "double latitude = 1;", "doubel latitude = 1;")
    (tree / "other.proto").write_text('syntax = "proto3";\n\nmessage Other {\n  int32 a = 1;\n}\n')
    code, all = found("protos", "--against", "main")
    assert (code, _said([one for one in all if one["id"] == "PRO101"], "path", "line")) == (1, [("imu.proto", 8)])


@pytest.mark.parametrize(
    ("before", "after", "code", "expected"),
    [
        (
            'import "gone.proto";',
            ("float accel_y = 2;", "string name = 2;"),
            1,
            [("STA102", "hint"), ("WIR101", "error")],
        ),
        ("message {", ("message {", "message { "), 2, [("STA102", "hint"), ("STA102", "fatal")]),
        ("message {", ("message {", ""), 0, [("STA102", "hint")]),
    ],
    ids=["an import is missing", "nothing can be read", "the change repairs it"],
)
def test_a_state_of_which_nothing_compiles(
    tmp_path: Path, found: Found, before: str, after: tuple[str, str], code: int, expected: list[tuple[str, str]]
) -> None:
    """A file that lacks an import is compared as far as it can be read; if nothing is compared, the lint fails."""
    root = RepositoryBuilder(tmp_path / "protos").commits({"imu.proto": f"{_IMU}{before}\n"}).write()
    _replace(root, "imu.proto", *after)
    got, all = found(root, "--against", "main")
    assert (got, sorted({one for one in _said(all, "id", "severity") if one[0] != "PRO101"})) == (
        code,
        sorted(expected),
    )


@pytest.mark.slow
def test_binary_and_enormous_files(tree: Path, found: Found) -> None:
    """A file that nobody wrote is named with exit code 2, and not read to its end."""
    (tree / "binary.proto").write_bytes(b"\x00\x01\x02" * 1000)
    (tree / "enormous.proto").write_text("// " + "x" * 9_000_000)
    large = "the file cannot be read: it has 9000003 bytes; files of more than 8388608 bytes are not read"
    expected = [("binary.proto", "the file is binary, and not the text of a .proto file"), ("enormous.proto", large)]
    code, all = found("protos", *_TREE)
    assert (code, _said(all, "path", "message")) == (2, expected)
    _commit(tree)
    for name, _ in expected:
        (tree / name).unlink()
    code, (hint,) = found("protos", *_MAIN)  # removing them is no fault
    assert (code, hint["severity"], hint["message"].endswith(": main:binary.proto, main:enormous.proto")) == (
        0,
        "hint",
        True,
    )


def test_what_is_no_file(tree: Path, found: Found) -> None:
    """A pipe, a device, a link to nothing, a name that is no text: named, never waited for; the rest is looked at."""
    os.mkfifo(tree / "pipe.proto")
    (tree / "device.proto").symlink_to("/dev/zero")
    (tree / "dangling.proto").symlink_to("gone.proto")
    (tree / os.fsdecode(b"l\xe4tin.proto")).write_text('syntax = "proto3";\n')
    (tree / "again").symlink_to(tree, target_is_directory=True)
    _replace(tree, *_DELETED)
    code, all = found("protos", *_MAIN)
    why = {
        one["path"]: one["message"].removeprefix("the file cannot be read: ") for one in all if one["id"] == "PRO102"
    }
    assert (code, [one["path"] for one in all if one["id"] == "WIR102"]) == (2, ["imu.proto"])
    assert why.pop("again")
    assert why == {
        "dangling.proto": "No such file or directory",
        "device.proto": "it is a link that leads out of the repository, or of the folder if there is none",
        "l\\xe4tin.proto": "the name of the file is not UTF-8",
        "pipe.proto": "it is not a regular file, but a folder, a pipe or a device",
    }
