"""The lint's verdict on each golden history; `golden_histories` describes the files."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from golden_histories import GoldenHistory, golden_histories
from repositories import RepositoryBuilder, envelope, git, message

from roverlink.__main__ import main


def _findings(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> list[dict[str, Any]]:
    """Findings of a command that are more than hints."""
    main([*arguments, "--format", "json"])
    said = capsys.readouterr()
    assert said.err == ""
    return [one for one in json.loads(said.out) if one["severity"] != "hint"]


def _about_a_number(finding: dict[str, Any]) -> bool:
    return None not in (finding["message_type"], finding["number"])


def _text(finding: dict[str, Any]) -> str:
    return " ".join([finding["message"], finding["help"] or "", *(also["text"] for also in finding["also"])])


@pytest.mark.parametrize("case", golden_histories(), ids=lambda case: case.name)
def test_golden_history(
    case: GoldenHistory, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The lint finds the numbers of the verdict with their severity, says what it has to say once, and no more."""
    monkeypatch.chdir(case.write(tmp_path / "repository"))
    found = _findings(case.command, capsys)
    numbers = {f"{one['severity']} {one['message_type']} {one['number']}" for one in found if _about_a_number(one)}
    assert numbers == case.verdict
    others = [f"{one['severity']} {_text(one)}" for one in found if not _about_a_number(one)]
    assert [sum(text in other for other in others) for text in case.says] == [1] * len(case.says)
    assert [other for other in others if not any(text in other for text in case.says)] == []


# --- what no text file holds -------------------------------------------------------------------------------------

_IDENTITY = ("-c", "user.name=A", "-c", "user.email=a@example.com")
_ARM = "protos/arm.proto"


@pytest.mark.parametrize("folder", ["protos", "a[b]/*/\\p?"])
def test_what_cannot_be_followed_is_said_once(
    folder: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A proto root that was a submodule has a history elsewhere: one hint names the commit where ours begins."""
    repository = RepositoryBuilder(tmp_path / "repository")
    repository.commit("Begin", {"README.md": "Text.\n"})
    root = repository.write()
    monkeypatch.chdir(root)
    git(root, "update-index", "--add", "--cacheinfo", f"160000,{'1' * 40},{folder}")
    git(root, *_IDENTITY, "commit", "--quiet", "--message", "Add the submodule")
    git(root, "rm", "--quiet", "--cached", f":(literal){folder}")
    Path(folder).mkdir(parents=True, exist_ok=True)
    for name in ("arm", "leg", "head"):
        Path(folder, f"{name}.proto").write_text(message(name.title(), "float voltage"))
    git(root, "add", "--all")
    git(root, *_IDENTITY, "commit", "--quiet", "--message", "Take the protos over")
    commit = git(root, "rev-parse", "HEAD")[:10]
    assert main(["lint", "--history", folder, "--format", "json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert [(one["id"], one["severity"], commit in _text(one)) for one in found] == [("STA108", "hint", True)]


@pytest.mark.parametrize("committed", [False, True], ids=["untracked", "committed"])
def test_a_link_out_of_the_tree_is_named(
    committed: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A symbolic link that leaves the repository is one finding with its path, and nothing behind it is read."""
    (tmp_path / "secret.proto").write_text('syntax = "proto3";\nmessage Secret { broken }\n')
    repository = RepositoryBuilder(tmp_path / "repository")
    repository.commit("Begin", {_ARM: message("Arm", "float voltage")})
    root = repository.write()
    monkeypatch.chdir(root)
    (root / "protos" / "link.proto").symlink_to("../../secret.proto")
    if committed:
        git(root, "add", "--all")
        git(root, *_IDENTITY, "commit", "--quiet", "--message", "Link")
    (found,) = _findings(["lint", "--history", "protos"], capsys)
    assert (found["path"], "link" in found["message"], "Secret" in _text(found)) == ("link.proto", True, False)


@pytest.mark.slow
def test_init_reads_comments_that_are_not_utf_8(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A Latin-1 degree sign in a comment, which protoc accepts, stops no project from starting."""
    repository = RepositoryBuilder(tmp_path / "repository")
    imu = message("Imu", "float roll").replace("roll = 1;", "roll = 1;  // up to 90 \udcb0")
    link = envelope("Imu imu = 1;").replace("\n\n", '\n\nimport "imu.proto";\n', 1)
    repository.commit("Begin", {"protos/imu.proto": imu, "protos/envelope.proto": link})
    monkeypatch.chdir(repository.write())
    assert main(["init", "--from", "protos", "--dry-run"]) == 0
