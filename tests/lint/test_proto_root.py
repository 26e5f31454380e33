"""The proto root of the lint: files that came into it from elsewhere, and a root that is the wrong folder."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from repositories import RepositoryBuilder, git, message

POSE = message("Pose", "float x", "float y", "float z", "int32 frame_id")
WITHOUT_Z = message("Pose", "float x", "float y", "int32 frame_id = 4;")
REUSED = message("Pose", "float x", "float y", "string label_text = 3;", "int32 frame_id = 4;")

Run = Callable[..., tuple[int, str, str]]
Found = Callable[..., tuple[int, list[dict[str, Any]]]]


def _ids(found: list[dict[str, Any]]) -> list[tuple[str, str | None, int | None]]:
    return [(one["id"], one["message_type"], one["number"]) for one in found]


# --- files from elsewhere ---


def test_the_history_follows_files_into_the_root(repository: RepositoryBuilder, found: Found) -> None:
    """Files were moved twice, the second time into the proto root and with a package: the reuse is found."""
    packaged = [text.replace("\n\n", "\n\npackage rover;\n\n", 1) for text in (WITHOUT_Z, REUSED)]
    repository.commit("Begin", {"pose.proto": POSE, "README.md": "Text."})
    repository.commit("Lose z", {"pose.proto": WITHOUT_Z})
    repository.commit("Move", {"pose.proto": None, "api/pose.proto": WITHOUT_Z})
    repository.commit("Move again", {"api/pose.proto": None, "proto/pose.proto": packaged[0]})
    repository.commit("Reuse", {"proto/pose.proto": packaged[1]})
    code, (one,) = found(repository.write() / "proto", "--history")
    assert code == 1
    assert _ids([one]) == [("HIS101", "rover.Pose", 3)]
    assert [use["path"] for use in one["history"]] == ["../pose.proto", "pose.proto"]


def test_other_files_elsewhere_do_not_count(repository: RepositoryBuilder, found: Found) -> None:
    """Outside of the root, and in a new file at the former path of a moved one, numbers may be reused."""
    repository.commit("Begin", {"api/pose.proto": WITHOUT_Z, "other/pose.proto": POSE})
    repository.commit("Move", {"api/pose.proto": None, "proto/pose.proto": WITHOUT_Z})
    repository.commit("Reuse elsewhere", {"other/pose.proto": REUSED, "api/pose.proto": POSE})
    repository.commit("And again", {"api/pose.proto": REUSED})
    assert found(repository.write() / "proto", "--history") == (0, [])


@pytest.mark.parametrize("staged", [True, False])
def test_a_move_that_is_not_committed_yet(repository: RepositoryBuilder, found: Found, staged: bool) -> None:
    """The file is followed before the commit, too, whether git was told of the move or not."""
    repository.commit("Begin", {"api/pose.proto": POSE, "proto/other.proto": message("Other", "bool on")})
    repository.commit("Lose z", {"api/pose.proto": WITHOUT_Z})
    root = repository.write()
    if staged:
        git(root, "mv", "api/pose.proto", "proto/pose.proto")
    else:
        (root / "api" / "pose.proto").rename(root / "proto" / "pose.proto")
    (root / "proto" / "pose.proto").write_text(REUSED)
    assert _ids(found(root / "proto", "--history")[1]) == [("HIS101", "Pose", 3)]


# --- the wrong root ---


@pytest.fixture
def tree(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with files that import each other from the folder `proto`; it is the current folder."""
    head = 'syntax = "proto3";\n\npackage rover;\n\n'
    (tmp_path / "proto" / "common").mkdir(parents=True)
    (tmp_path / "proto" / "common" / "header.proto").write_text(f"{head}message Header {{ uint32 stamp = 1; }}\n")
    (tmp_path / "proto" / "sensors").mkdir()
    for name in ("Imu", "Gps", "Ph"):
        text = f'{head}import "common/header.proto";\n\nmessage {name} {{ rover.Header header = 1; }}\n'
        (tmp_path / "proto" / "sensors" / f"{name.lower()}.proto").write_text(text)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize(("root", "file"), [(".", "proto/sensors/gps.proto"), ("proto/sensors", "gps.proto")])
def test_a_wrong_root_is_one_line_that_names_the_right_one(tree: Path, run: Run, root: str, file: str) -> None:
    """A folder above or below the right one gives one finding in place of one for each import."""
    code, out, _ = run("lint", root)
    said, *help = out.splitlines()
    imports = f"3 of 3 imports, such as 'common/header.proto' in '{file}', are not found from here"
    assert (code, said) == (2, f"{root}: fatal[STA107] {imports}; they start at 'proto'")
    assert help == ["  help: give the folder 'proto' as the proto root", "", "1 fatal error"]


def test_a_missing_file_is_no_wrong_root(tree: Path, run: Run) -> None:
    """One import that is not found, among others that are, is an error of the file."""
    assert run("lint", "proto")[0] == 0
    (tree / "proto" / "sensors" / "arm.proto").write_text('syntax = "proto3";\nimport "gps.proto";\n')
    code, out, _ = run("lint", "proto")
    assert (code, "error[PRO101]" in out) == (1, True)
