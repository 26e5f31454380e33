"""The other state of `roverlink lint --against`: git refs, folders, descriptor sets, and all that is none of them."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from roverlink.__main__ import main

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

_NO_SETTINGS = {"GIT_CONFIG_GLOBAL": os.devnull, "GIT_CONFIG_SYSTEM": os.devnull}  # of whoever runs the tests

Said = tuple[int, str, str]
Lint = Callable[..., Said]


@pytest.fixture
def tree(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A tree of protos without a table, committed to a repository of its own; the current folder is above it."""
    root = tmp_path / "protos"
    root.mkdir()
    (root / "envelope.proto").write_text(_ENVELOPE)
    (root / "imu.proto").write_text(_IMU)
    monkeypatch.chdir(tmp_path)
    for name in ("GIT_DIR", "GIT_WORK_TREE", "GIT_INDEX_FILE"):
        monkeypatch.delenv(name, raising=False)
    _git(root, "init", "--quiet", "--initial-branch", "main")
    _commit(root, "Add the IMU")
    return root


def _git(root: Path, *arguments: str) -> str:
    identity = {
        f"GIT_{who}_{what}": f"{who}@example.com" for who in ("AUTHOR", "COMMITTER") for what in ("NAME", "EMAIL")
    }
    dates = {"GIT_AUTHOR_DATE": "2026-03-01T12:00:00Z", "GIT_COMMITTER_DATE": "2026-03-01T12:00:00Z"}
    done = subprocess.run(
        ["git", "-C", str(root), *arguments],
        env={**os.environ, **identity, **dates, **_NO_SETTINGS},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def _commit(root: Path, subject: str) -> None:
    _git(root, "add", "--all")
    _git(root, "commit", "--quiet", "--message", subject)


def _replace(file: Path, before: str, after: str) -> None:
    text = file.read_text()
    assert before in text
    file.write_text(text.replace(before, after))


@pytest.fixture
def lint(capsys: pytest.CaptureFixture[str]) -> Lint:
    """`roverlink lint` in this process."""

    def run(*arguments: str | Path) -> Said:
        code = main(["lint", *map(str, arguments)])
        said = capsys.readouterr()
        return code, said.out, said.err

    return run


def _found(out: str) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = json.loads(out)
    return found


# --- the three kinds of states ----------------------------------------------------------------------------------


def _against_ref(tree: Path) -> str:
    return "main"


def _against_folder(tree: Path) -> str:
    folder = tree.parent / "old"
    _git(tree, "worktree", "add", "--quiet", str(folder), "--detach", "main")
    return "old"


def _against_descriptor_set(tree: Path) -> str:
    _git(tree, "stash", "--quiet")
    command = [sys.executable, "-m", "grpc_tools.protoc", f"-I{tree}", "--descriptor_set_out=old.binpb"]
    subprocess.run([*command, "--include_imports", "envelope.proto"], check=True, cwd=tree.parent)
    _git(tree, "stash", "pop", "--quiet")
    return "old.binpb"


@pytest.mark.parametrize("against", [_against_ref, _against_folder, _against_descriptor_set])
def test_a_change_is_found_against_every_kind_of_state(tree: Path, lint: Lint, against: Callable[[Path], str]) -> None:
    """A number that was given to another payload is found at its place, whatever the other state comes from."""
    _replace(tree / "envelope.proto", "Gps gps = 2", "Imu backup_imu = 2")
    code, out, err = lint("protos", "--against", against(tree), *_TREE, "--format", "json")
    assert (code, err) == (1, "")
    reuse = [found for found in _found(out) if found["id"] == "ENV102"]
    assert len(reuse) == 1
    assert (reuse[0]["path"], reuse[0]["line"], reuse[0]["number"]) == ("envelope.proto", 8, 2)


def test_no_change_is_no_finding(tree: Path, lint: Lint) -> None:
    """The same state against itself is clean."""
    assert lint("protos", "--against", "main", *_TREE) == (0, "No problems found.\n", "")


def test_the_commit_of_the_earlier_place_is_named(tree: Path, lint: Lint) -> None:
    """Where the other state is a ref, a finding says with which commit the first use came: id, date, subject."""
    _replace(tree / "envelope.proto", "Gps gps = 2", "Imu backup_imu = 2")
    id = _git(tree, "rev-parse", "--short=10", "main").strip()
    _, out, _ = lint("protos", "--against", "main", *_TREE)
    assert f"main:envelope.proto:8:5: published here ({id} 2026-03-01 Add the IMU)" in out


def test_a_line_that_is_not_committed_has_no_commit(tree: Path, lint: Lint) -> None:
    """Of a working copy's own line, nothing is made up."""
    (tree / "again.proto").write_text('syntax = "proto3";\n\npackage again;\n\nmessage Imu {}\n')
    code, out, _ = lint("protos", *_TREE)
    assert code == 1
    assert "  protos/again.proto:5:1: first declared here\n" in out


def test_a_ref_sees_the_folder_it_is_asked_for(tree: Path, lint: Lint) -> None:
    """A tree that is a folder within the repository is compared with that folder, and with nothing beside it."""
    (tree / "sub").mkdir()
    for name in ("envelope.proto", "imu.proto"):
        (tree / name).rename(tree / "sub" / name)
    (tree / "broken.proto").write_text("message {")
    _commit(tree, "Move all")
    _replace(tree / "sub" / "imu.proto", "float accel_y = 2;", "")
    code, out, _ = lint(tree / "sub", "--against", "main", *_TREE, "--format", "json")
    assert code == 1
    assert {(found["path"], found["message_type"]) for found in _found(out)} == {("imu.proto", "Imu")}


# --- bad input --------------------------------------------------------------------------------------------------


def test_no_such_state(tree: Path, lint: Lint) -> None:
    """What is no folder, no file and no ref is said, with exit code 2."""
    code, out, err = lint("protos", "--against", "mian", *_TREE)
    assert (code, err) == (2, "")
    assert "fatal[STA101] 'mian' is not a folder, a file, or a git ref" in out


def test_a_branch_of_the_remote_is_offered(tree: Path, lint: Lint, tmp_path: Path) -> None:
    """A clone of a CI server has no branch main of its own; the help names the one that it has."""
    clone = tmp_path / "clone"
    _git(tmp_path, "clone", "--quiet", str(tree), str(clone))
    _git(clone, "switch", "--quiet", "--detach")
    _git(clone, "branch", "--quiet", "--delete", "--force", "main")
    code, out, _ = lint(clone, "--against", "main", *_TREE)
    assert code == 2
    assert "  help: write 'origin/main': this clone has 'main' only as a branch of the remote" in out.splitlines()


def test_the_rest_is_looked_at_without_the_other_state(tree: Path, lint: Lint) -> None:
    """Where there is no such state, it is one finding among those of the present, in any format."""
    _replace(tree / "imu.proto", "latitude = 1;", "latitude = 1;\n  // double age = 2;\n  float hdop = 2;")
    code, out, _ = lint("protos", "--against", "mian", *_TREE, "--format", "json")
    assert code == 2
    assert [(found["id"], found["severity"]) for found in _found(out)] == [("STA101", "fatal"), ("ENV109", "warning")]


def test_no_repository(tmp_path: Path, lint: Lint, monkeypatch: pytest.MonkeyPatch) -> None:
    """Outside a repository there is no ref; git's own words say why."""
    monkeypatch.setenv("GIT_CEILING_DIRECTORIES", str(tmp_path.parent))
    (tmp_path / "imu.proto").write_text(_IMU)
    code, out, _ = lint(tmp_path, "--against", "main")
    assert code == 2
    assert "STA101" in out


def test_an_option_is_no_ref(tree: Path, lint: Lint) -> None:
    """What starts with a dash is not handed to git as an option."""
    code, out, _ = lint("protos", "--against=--help", *_TREE)
    assert code == 2
    assert "STA101" in out


@pytest.mark.parametrize(
    ("data", "said"),
    [(b"", "the descriptor set contains no .proto file"), (b"\xff\xff\xff", "the file is not a descriptor set")],
)
def test_no_descriptor_set(tree: Path, lint: Lint, data: bytes, said: str) -> None:
    """A file that is not a descriptor set, or an empty one, is no state: nothing passes in silence."""
    Path("old.binpb").write_bytes(data)
    code, out, _ = lint("protos", "--against", "old.binpb", *_TREE)
    assert code == 2
    assert f"old.binpb: fatal[STA102] {said}" in out


def test_a_folder_without_protos(tree: Path, lint: Lint) -> None:
    """A folder with nothing to look at is no clean state, be it this one or the other."""
    Path("empty").mkdir()
    code, out, _ = lint("protos", "--against", "empty", *_TREE)
    assert (code, "empty: fatal[STA102] the earlier state contains no .proto file" in out) == (2, True)
    code, out, _ = lint("empty", *_TREE)
    assert (code, "fatal[STA103] the folder contains no .proto file" in out) == (2, True)


def test_a_folder_that_is_not_there(lint: Lint, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A tree that is not there is said, not taken for an empty one."""
    monkeypatch.chdir(tmp_path)
    code, out, _ = lint("nowhere")
    assert code == 2
    assert "STA103" in out


def test_no_such_envelope(tree: Path, lint: Lint) -> None:
    """An envelope that no file declares is said."""
    code, out, _ = lint("protos", "--envelope", "envelope.proto", "--message", "PBEnvelope")
    assert code == 2
    assert "fatal[STA104] no message 'PBEnvelope' is declared" in out


def test_an_envelope_that_does_not_compile(tree: Path, lint: Lint) -> None:
    """Where the envelope is missing, it is said why: its file has an error."""
    _replace(tree / "envelope.proto", "Gps gps = 2;", "Gps gps = 2")
    code, out, _ = lint("protos", *_TREE)
    assert code == 2
    assert 'envelope.proto:9:3: error[PRO101] Expected ";"' in out
    assert "fatal[STA104] the message 'Envelope' is declared in envelope.proto, which does not compile" in out
    assert "  help: correct the errors in envelope.proto\n" in out


@pytest.mark.parametrize(
    ("named", "said"),
    [
        (
            ("--envelope", "no.proto", "--message", "Envelope"),
            "the message 'Envelope' is declared in envelope.proto, not in no",
        ),
        (("--envelope", "envelope.proto"), "the envelope's message is not named"),
        (("--message", "Envelop"), "no message 'Envelop' is declared"),
    ],
)
def test_words_that_name_no_envelope(tree: Path, lint: Lint, named: tuple[str, ...], said: str) -> None:
    """A file or a message that is not the envelope's is said, and not passed over."""
    code, out, _ = lint("protos", *named)
    assert code == 2
    assert f"fatal[STA104] {said}" in out


def test_an_envelope_named_without_its_package(tree: Path, lint: Lint) -> None:
    """The last part of its name is enough, as long as there is one such message."""
    for name in ("envelope.proto", "imu.proto"):
        _replace(tree / name, 'syntax = "proto3";\n', 'syntax = "proto3";\n\npackage rover;\n')
    _commit(tree, "Have a package")
    _replace(tree / "envelope.proto", "Gps gps = 2;", "Gps gps = 3;")
    code, out, _ = lint("protos", "--against", "main", *_TREE, "--format", "json")
    assert code == 1
    assert [(found["id"], found["message_type"]) for found in _found(out)] == [("ENV107", "rover.Envelope")]
    (tree / "other.proto").write_text('syntax = "proto3";\n\npackage other;\n\nmessage Envelope {}\n')
    code, out, _ = lint("protos", *_TREE)
    assert code == 2
    assert "help: use --message rover.Envelope or --message other.Envelope" in out


def test_a_name_that_went_along_is_not_to_be_reserved(tree: Path, lint: Lint) -> None:
    """What is to be written compiles: a name that another number has now cannot be reserved."""
    _replace(tree / "envelope.proto", "Gps gps = 2;", "Gps gps = 3;")
    _, out, _ = lint("protos", "--against", "main", *_TREE, "--format", "json")
    assert [(found["id"], found["help"]) for found in _found(out)] == [
        ("ENV107", "add `reserved 2;` to the message 'Envelope'")
    ]


def test_numbers_and_texts_are_members_of_a_tree_s_envelope(tree: Path, lint: Lint) -> None:
    """An envelope that carries more than messages agrees with itself."""
    _replace(tree / "envelope.proto", "Gps gps = 2;", "Gps gps = 2;\n    uint32 timeout = 3;\n    string text = 4;")
    assert lint("protos", *_TREE)[0] == 0


def test_the_repository_is_that_of_the_folder(tree: Path, lint: Lint, monkeypatch: pytest.MonkeyPatch) -> None:
    """In a hook, git says which repository it runs in; what is looked at may stand in another one."""
    other = tree.parent / "other"
    other.mkdir()
    _git(other, "init", "--quiet", "--initial-branch", "main")
    _git(other, "commit", "--quiet", "--allow-empty", "--message", "Nothing")
    _replace(tree / "imu.proto", "float accel_y = 2;", "")
    for name in ("GIT_DIR", "GIT_WORK_TREE"):
        monkeypatch.setenv(name, str(other / ".git" if name == "GIT_DIR" else other))
    code, out, _ = lint("protos", "--against", "main", *_TREE, "--format", "json")
    assert code == 1
    (found,) = _found(out)
    assert (found["id"], found["also"][0]["commit"]["subject"]) == ("WIR102", "Add the IMU")


def test_the_other_state_does_not_compile(tree: Path, lint: Lint) -> None:
    """What could not be looked at is named and ends with 2; the rest is compared all the same."""
    (tree / "broken.proto").write_text('syntax = "proto3";\n\nmessage Broken {\n  Missing x = 1;\n}\n')
    _commit(tree, "Break one file")
    (tree / "broken.proto").unlink()
    _replace(tree / "imu.proto", "float accel_y = 2;", "")
    code, out, _ = lint("protos", "--against", "main", *_TREE, "--format", "json")
    found = {finding["id"]: finding for finding in _found(out)}
    assert code == 2
    assert found["STA102"]["path"] == "main:broken.proto"
    assert found["STA102"]["severity"] == "fatal"
    assert {"imu.proto"} <= {finding["path"] for finding in found.values()}


def test_this_state_does_not_compile(tree: Path, lint: Lint) -> None:
    """A file that does not compile is a finding with protoc's words; the others are looked at all the same."""
    _replace(tree / "imu.proto", "double latitude = 1;", "doubel latitude = 1;")
    (tree / "other.proto").write_text('syntax = "proto3";\n\nmessage Other {\n  int32 a = 1;\n}\n')
    code, out, err = lint("protos", "--against", "main", "--format", "json")
    assert (code, err) == (1, "")
    assert [(f["path"], f["line"]) for f in _found(out) if f["id"] == "PRO101"] == [("imu.proto", 9)]


def test_binary_and_enormous_files(tree: Path, lint: Lint) -> None:
    """A file that nobody wrote is named with exit code 2, and not read to its end."""
    (tree / "binary.proto").write_bytes(b"\x00\x01\x02" * 1000)
    (tree / "enormous.proto").write_text("// " + "x" * 9_000_000)
    expected = {
        "binary.proto": "the file is binary, and not the text of a .proto file",
        "enormous.proto": "the file cannot be read: "
        "it has 9000003 bytes; files of more than 8388608 bytes are not read",
    }
    code, out, _ = lint("protos", *_TREE, "--format", "json")
    assert (code, {finding["path"]: finding["message"] for finding in _found(out)}) == (2, expected)
    _commit(tree, "Add what nobody wrote")
    for name in expected:
        (tree / name).unlink()
    code, out, _ = lint("protos", "--against", "main", *_TREE, "--format", "json")
    expected = {f"main:{name}": message for name, message in expected.items()}
    assert (code, {finding["path"]: finding["message"] for finding in _found(out)}) == (2, expected)


def test_what_is_no_file(tree: Path, lint: Lint) -> None:
    """A pipe, a device, a link to nothing, a name that is no text: named, never waited for; the rest is looked at."""
    os.mkfifo(tree / "pipe.proto")
    (tree / "device.proto").symlink_to("/dev/zero")
    (tree / "dangling.proto").symlink_to("gone.proto")
    (tree / os.fsdecode(b"l\xe4tin.proto")).write_text('syntax = "proto3";\n')
    _replace(tree / "imu.proto", "float accel_y = 2;", "")
    code, out, _ = lint("protos", "--against", "main", *_TREE, "--format", "json")
    assert code == 2
    assert [
        (found["id"], found["path"], found["message"].removeprefix("the file cannot be read: "))
        for found in _found(out)
    ] == [
        ("PRO102", "dangling.proto", "No such file or directory"),
        ("PRO102", "device.proto", "it is a link that leads out of the repository, or of the folder if there is none"),
        ("WIR102", "imu.proto", "`accel_y = 2` was deleted from 'Imu', but its number is not reserved"),
        ("PRO102", "l\\xe4tin.proto", "the name of the file is not UTF-8"),
        ("PRO102", "pipe.proto", "it is not a regular file, but a folder, a pipe or a device"),
    ]


def test_a_link_in_circles(tree: Path, lint: Lint) -> None:
    """A link that leads back is named with exit code 2; nothing runs for ever."""
    (tree / "again").symlink_to(tree, target_is_directory=True)
    code, out, _ = lint("protos", *_TREE, "--format", "json")
    assert code == 2
    assert [(f["id"], f["path"]) for f in _found(out) if f["severity"] == "fatal"] == [("PRO102", "again")]
