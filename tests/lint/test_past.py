"""The lint of all of history, of all branches and of every consumer, as users call it."""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from repositories import ENVELOPE_FILE, RepositoryBuilder, envelope, git, message

_TREE = ("--envelope", ENVELOPE_FILE, "--message", "PBEnvelope")
_PAYLOADS = {
    "components/imu.proto": message("Imu", "float accel_x", "float accel_y", "float accel_z"),
    "components/gps.proto": message("Gps", "double latitude", "double longitude", "uint32 satellites"),
    "components/wind.proto": message("Wind", "string direction", "bytes raw", "bool gusty"),
}
_IMPORTS = "".join(f'import "{path}";\n' for path in _PAYLOADS)
_IDENTITY = ("-c", "user.name=A", "-c", "user.email=a@example.com")
_GPS, _WIND = "Gps gps = 2;", "Wind wind = 2;"

Run = Callable[..., tuple[int, str, str]]
Found = Callable[..., tuple[int, list[dict[str, Any]]]]


def _text(*members: str, closed: str = "") -> str:
    """The envelope's file, whose first member is always the IMU."""
    text = envelope("Imu imu = 1;", *members).replace("\n\n", f"\n\n{_IMPORTS}\n", 1)
    return text.replace("  oneof", f"  {closed}\n  oneof") if closed else text


def _envelope(*members: str, closed: str = "") -> dict[str, str]:
    return {ENVELOPE_FILE: _text(*members, closed=closed)}


@pytest.fixture
def repository(tmp_path: Path) -> RepositoryBuilder:
    """A repository of protos whose first commit has two payloads."""
    built = RepositoryBuilder(tmp_path / "protos")
    built.commit("Begin", {**_envelope(_GPS), **_PAYLOADS})
    return built


@pytest.fixture
def windy(repository: RepositoryBuilder) -> Path:
    """The same repository, checked out, after the number 2 was given to another payload."""
    repository.commit("Measure the wind", _envelope(_WIND))
    return repository.write()


# --- history ---


@pytest.mark.parametrize(
    ("files", "said"),
    [
        (_envelope(closed="reserved 2;"), "today it is reserved"),
        (dict.fromkeys((ENVELOPE_FILE, *_PAYLOADS)), "today 'PBEnvelope' does not exist"),
    ],
    ids=["reserved", "all protos are gone"],
)
def test_what_became_of_the_number_is_said(
    repository: RepositoryBuilder, found: Found, files: dict[str, str | None], said: str
) -> None:
    """A number of the past that nobody can take any more is found, and so is one of a tree that was deleted."""
    repository.commit("Measure the wind", _envelope(_WIND))
    repository.commit("Close it", files)
    code, (one,) = found("--history", repository.write(), *_TREE)
    assert (code, one["number"], said in one["message"]) == (1, 2, True)


def test_a_mere_rename_of_a_payload_is_a_hint(repository: RepositoryBuilder, found: Found) -> None:
    """A payload that got another name, and kept its fields, is found by a rule of its own."""
    renamed = _PAYLOADS["components/imu.proto"].replace("message Imu", "message ImuInfo")
    files = {ENVELOPE_FILE: _text(_GPS).replace("Imu imu", "ImuInfo imu"), "components/imu.proto": renamed}
    repository.commit("Rename the IMU", files)
    code, (one,) = found("--history", repository.write(), *_TREE)
    assert (code, one["id"], one["number"], one["severity"]) == (0, "HIS102", 1, "hint")


@pytest.mark.slow
def test_against_a_branch_makes_its_own_old_cases_hints(repository: RepositoryBuilder, run: Run, found: Found) -> None:
    """What the base and somebody else's open branch have done passes; a case that the change adds is an error."""
    begun = repository.commit("Drop the GPS", _envelope())
    repository.commit("Measure the wind", _envelope(_WIND))
    repository.branch("base")
    repository.commit("Forgotten", _envelope("Imu third = 2;"), branch="stale", parents=[begun])
    root = repository.write()
    assert found("--history", root, *_TREE)[0] == 1
    code, (one, *branches) = found("--history", "--branches", root, *_TREE, "--against", "base")
    assert (code, one["id"], one["severity"], one["known"]) == (0, "HIS101", "hint", True)
    assert [(other["id"], other["known"]) for other in branches] == [("HIS104", True)]
    known = "No new problems found (1 known problem not shown; --all shows it)\n"
    assert run("lint", "--history", root, *_TREE, "--against", "base")[1] == known
    assert "1 hint\n" in run("lint", "--history", root, *_TREE, "--against", "base", "--all")[1]
    (root / ENVELOPE_FILE).write_text(_text("Imu second = 2;"))  # a third meaning
    code, against = found("--history", root, *_TREE, "--against", "base")
    assert (code, ("HIS101", "error") in [(one["id"], one["severity"]) for one in against]) == (1, True)
    (root / ENVELOPE_FILE).write_text(_text(_GPS))  # a repair of the base, and of what main did before
    assert [found("--history", root, *_TREE, "--against", base)[0] for base in ("base", "main~2")] == [0] * 2


# --- what limits how deep one can look ---


@pytest.mark.slow
def test_a_shallow_clone_says_how_deep_it_could_look(windy: Path, tmp_path: Path, run: Run) -> None:
    """The part that is there is looked at; that it is a part is a warning with its depth and the cure.

    Beside an envelope that does not compile, the next number may not be the last word either.
    """
    git(tmp_path, "clone", "--quiet", "--depth", "1", f"file://{windy}", "shallow")
    root = tmp_path / "shallow"
    code, out, _ = run("lint", "--history", root, *_TREE)
    assert (code, out.count("["), "warning[STA106]" in out) == (1, 1, True)
    assert "its history goes back only 1 commit" in out
    assert "git fetch --unshallow" in out
    (root / ENVELOPE_FILE).write_text(_text("Wind wind = 2; Imu other = 3"))
    for arguments in (["number", "next", root], ["number", "history", "2", root]):
        _, _, err = run(*arguments, *_TREE)
        assert ("warning[STA106] this is a shallow clone" in err, "error[PRO101]" in err) == (True, True)
    assert run("number", "next", root, *_TREE)[1] == "4\n"


# --- branches, pins, numbers ---


def test_branches_that_took_one_number(repository: RepositoryBuilder, run: Run, found: Found) -> None:
    """The collision is found before the merge, with both branches, and a number that neither has."""
    repository.branch("wind")
    repository.branch("imu")
    repository.commit("Wind", _envelope(_GPS, "Wind wind = 3;"), branch="wind")
    repository.commit("IMU", _envelope(_GPS, "Imu spare = 3;"), branch="imu")
    root = repository.write()
    code, (one,) = found(root, "--branches", *_TREE)
    assert (code, one["id"], one["number"]) == (1, "HIS104", 3)
    assert "is 'spare' (Imu) on the branch imu and 'wind' (Wind) on the branch wind" in one["message"]
    assert [(use["declaration"], use["line"], use["today"]) for use in one["history"]] == [
        ("Imu spare = 3;", 11, "on the branch imu"),
        ("Wind wind = 3;", 11, "on the branch wind"),
    ]
    assert one["help"] == "keep the number for one of them, and give the other one the number 4, which no branch uses"
    assert run("lint", root, *_TREE)[0] == 0


def _cmake(folder: Path, text: str) -> Path:
    """A consumer that fetches the protos with CMake."""
    folder.mkdir()
    (folder / "CMakeLists.txt").write_text(text)
    return folder


@pytest.mark.slow
def test_pins_that_disagree(windy: Path, tmp_path: Path, run: Run, found: Found) -> None:
    """A submodule, CMake's GIT_TAG and a plain list: a number that two commits use differently is one finding."""
    new, old = git(windy, "rev-parse", "HEAD").strip(), git(windy, "rev-parse", "HEAD~1").strip()
    rover = tmp_path / "rover"
    rover.mkdir()
    (rover / ".gitmodules").touch()
    git(rover, "init", "--quiet")
    git(rover, "update-index", "--add", "--cacheinfo", f"160000,{old},protos")
    git(rover, *_IDENTITY, "commit", "--quiet", "--message", "Pin")
    declared = f"FetchContent_Declare(protos\n  GIT_REPOSITORY x\n  GIT_TAG {new})  # GIT_TAG {old}\n"
    board = _cmake(tmp_path / "board", f"{declared}FetchContent_Declare(other GIT_TAG v9.9)\n")
    (tmp_path / "pins.txt").write_text(f"# who uses what\nbasestation {old[:12]}\n")
    sources = (rover, board, tmp_path / "pins.txt")
    code, (one,) = found(windy, *_TREE, "--pins", *sources)
    assert (code, one["path"], one["message"]) == (
        1,
        ENVELOPE_FILE,
        "number 2 of 'PBEnvelope' is `Gps gps = 2;` in 'rover/protos' and 'basestation', "
        "but `Wind wind = 2;` in this checkout and 'board/protos'",
    )
    pins = {Path(each["path"]).name: each["text"] for each in one["also"]}
    assert pins["CMakeLists.txt"] == f"'board/protos' is pinned to {new[:10]} 2026-02-04 Measure the wind"
    assert pins[".gitmodules"] == f"'rover/protos' and 'basestation' are pinned to {old[:10]} 2026-02-03 Begin"
    lines = [" ".join(line.split()) for line in run("lint", windy, *_TREE, "--pins", *sources)[1].splitlines()]
    matrix = [line for line in lines if re.fullmatch(r"\d+ .*(same|misread \d+)", line)]
    assert matrix == ["1 rover/protos, same misread 1", "2 this checkout, misread 1 same"]


_UNKNOWN = "which this repository does not have"


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        # A consumer that is pinned to a commit nobody fetched is not one that agrees.
        ("team/protos.git", None, f"the project 'board/x' is pinned to '0123abc', {_UNKNOWN}"),
        ("json.git", None, "none of the pins here is a commit of this repository: board/x (0123abc)"),
        ("", "rover 0123456789abcdef\n", f"the project 'rover' is pinned to '0123456789abcdef', {_UNKNOWN}"),
        ("", "a b c d\n", "the line 'a b c d' is not a name and a commit, such as `rover 4f1c2ab`"),
        ("", "# nothing\n", "the file or folder contains no pin"),
        ("", "rover \0\n", "the file is binary, and not a list of pins"),
        ("", "rover empty\n", "the project 'rover' is pinned to 'empty', which has no message 'PBEnvelope'"),
    ],
)
def test_pins_that_cannot_be_read(
    repository: RepositoryBuilder, tmp_path: Path, run: Run, name: str, text: str | None, said: str
) -> None:
    """A commit that is not there or has no envelope, a line or a source that says nothing: named, with exit code 2."""
    repository.commit("Begin elsewhere", {"README.md": "Nothing."}, branch="empty", parents=[])
    if text is None:
        fetched = f"FetchContent_Declare(x GIT_REPOSITORY https://example.com/{name} GIT_TAG 0123abc)\n"
        pins = _cmake(tmp_path / "board", fetched)
    else:
        pins = tmp_path / "pins.txt"
        pins.write_text(text)
    code, out, _ = run("lint", repository.write(), *_TREE, "--pins", pins)
    assert (code, f"fatal[PIN101] {said}" in out) == (2, True)


def test_the_next_number_skips_whatever_was_used(repository: RepositoryBuilder, run: Run) -> None:
    """No number of the history, of another branch, of a reserved range or a comment is offered; it is said why.

    The branch may have renamed a message of its own to the envelope's name.
    """
    late = _text("Imu late = 7;")
    repository.commit("Draft", {"late.proto": late.replace("PBEnvelope", "Draft")}, branch="draft", parents=[])
    repository.commit("Rename", {"late.proto": late}, branch="draft")
    repository.commit("Try 3", _envelope(_GPS, "Wind wind = 3;"))
    repository.branch("side")
    repository.commit("Take 4", _envelope("Imu other = 4;"), branch="side")
    repository.commit("Go on", _envelope(_GPS, "// Wind later = 5;", closed="reserved 6;"))
    code, out, err = run("number", "next", repository.write(), *_TREE)
    assert (code, out) == (0, "8\n")
    expected = ["3 was 'wind' (Wind) until ", "4 is 'other' (Imu) on the branch side", "5 ", "6 is reserved in "]
    expected.append("7 is 'late' (Imu) on the branch draft")
    lines = [" ".join(line.split()) for line in err.splitlines()]
    assert [line.startswith(start) for line, start in zip(lines, expected, strict=True)] == [True] * 5
    assert "comment" in lines[2]


@pytest.mark.slow
def test_the_next_number_skips_what_is_closed(repository: RepositoryBuilder, run: Run) -> None:
    """Ranges are skipped as a whole, and said in one line; where all above is closed, what is left below is taken."""
    text = _text(_GPS, closed="extensions 3 to 9; reserved 12 to max; optional uint32 outside = 10;")
    repository.commit("Close", {ENVELOPE_FILE: text.replace("proto3", "proto2")})
    root = repository.write()
    code, out, err = run("number", "next", root, *_TREE)
    assert (code, out, err.splitlines()[0]) == (0, "11\n", f"3 to 9 is for extensions in {ENVELOPE_FILE}")
    file = root / ENVELOPE_FILE
    file.write_text(file.read_text().replace("12 to max", "11 to max"))
    shutil.rmtree(root / ".git")
    code, out, err = run("number", "next", root, *_TREE)
    assert (code, out, "no number is left" in err) == (2, "", True)
    file.write_text(file.read_text().replace("3 to 9", "4 to 9"))
    assert run("number", "next", root, *_TREE)[:2] == (0, "3\n")


# --- accepting ---


@pytest.mark.slow
@pytest.mark.parametrize("question", [[], ["--branches"]])
def test_accepting_needs_the_history(question: list[str], run: Run) -> None:
    """Nothing is accepted where nobody asked what there is."""
    code, out, _ = run("lint", *question, "--accept")
    assert (code, "fatal[RET102]" in out) == (2, True)
