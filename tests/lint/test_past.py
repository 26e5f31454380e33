"""The lint of all of history, of all branches and of every consumer, as users call it."""

from __future__ import annotations

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from repositories import RepositoryBuilder, envelope, git, message

from roverlink.__main__ import main

ROOT = Path(__file__).parents[2]
_FILE = "components/common/envelope.proto"
_TREE = ("--envelope", _FILE, "--message", "PBEnvelope")
_PAYLOADS = {
    "components/imu.proto": message("Imu", "float accel_x", "float accel_y", "float accel_z"),
    "components/gps.proto": message("Gps", "double latitude", "double longitude", "uint32 satellites"),
    "components/wind.proto": message("Wind", "string direction", "bytes raw", "bool gusty"),
}
_IMPORTS = "".join(f'import "{path}";\n' for path in _PAYLOADS)

Said = tuple[int, str, str]
Run = Callable[..., Said]


def _envelope(*members: str) -> str:
    return envelope(*members).replace("\n\n", f"\n\n{_IMPORTS}\n", 1)


@pytest.fixture
def repository(tmp_path: Path) -> RepositoryBuilder:
    """A repository of protos whose first commit has two payloads."""
    built = RepositoryBuilder(tmp_path / "protos")
    built.commit("Begin", {_FILE: _envelope("Imu imu = 1;", "Gps gps = 2;"), **_PAYLOADS})
    return built


def _written(repository: RepositoryBuilder) -> Path:
    root = repository.write()
    git(root, "checkout", "--quiet", "--force", "main")
    return root


def _found(out: str) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = json.loads(out)
    return found


# --- history ----------------------------------------------------------------------------------------------------


def test_a_number_that_was_reused_is_found_with_its_whole_life(repository: RepositoryBuilder, run: Run) -> None:
    """Deleted in one commit and given away two commits later: who held it, and by which commits it came and went."""
    repository.commit("Take GPS away", {_FILE: _envelope("Imu imu = 1;")})
    repository.commit("Write about it", {"README.md": "Nothing."})
    repository.commit("Measure the wind", {_FILE: _envelope("Imu imu = 1;", "Wind wind = 2;")})
    root = _written(repository)
    commits = dict(line.split(" ", 1)[::-1] for line in git(root, "log", "--format=%H %s").splitlines())
    code, out, err = run("lint", "--history", root, *_TREE, "--format", "json")
    assert (code, err) == (1, "")
    (found,) = _found(out)
    assert (found["id"], found["name"], found["severity"]) == ("HIS101", "number-reused-in-history", "error")
    assert (found["message_type"], found["number"], found["path"], found["line"]) == ("PBEnvelope", 2, _FILE, 10)
    assert [(use["type"], use["name"], use["first_commit"], use["last_commit"]) for use in found["history"]] == [
        ("Gps", "gps", commits["Begin"], commits["Take GPS away"]),
        ("Wind", "wind", commits["Measure the wind"], None),
    ]
    assert found["message"] == (
        "number 2 of 'PBEnvelope' was given to 'wind' (Wind) after 'gps' (Gps) was removed: "
        "'Wind' has 0 of the 3 fields of 'Gps'"
    )
    assert [(use["declaration"], use["path"], use["line"], use["first_author"]) for use in found["history"]] == [
        ("Gps gps = 2;", _FILE, 10, "A B"),
        ("Wind wind = 2;", _FILE, 10, "A B"),
    ]


def test_a_merged_side_branch_is_not_overlooked(repository: RepositoryBuilder, run: Run) -> None:
    """What first parents never had: a side branch gave the number to something else, and its merge took that back."""
    repository.branch("side")
    tip = repository.commit("Try the wind", {_FILE: _envelope("Imu imu = 1;", "Wind wind = 2;")}, branch="side")
    main_tip = repository.commit("Write", {"README.md": "Text."})
    merged = {_FILE: _envelope("Imu imu = 1;", "Gps gps = 2;")}
    repository.commit("Merge side", merged, parents=[main_tip, tip])
    repository.delete_branch("side")
    code, out, _ = run("lint", "--history", _written(repository), *_TREE, "--format", "json")
    assert code == 1
    assert [(one["name"], one["number"]) for one in _found(out)] == [("number-reused-in-history", 2)]


def test_today_that_is_reserved_is_said(repository: RepositoryBuilder, run: Run) -> None:
    """A number of the past that nobody can take any more is found, and said to be reserved."""
    repository.commit("Measure the wind", {_FILE: _envelope("Imu imu = 1;", "Wind wind = 2;")})
    closed = _envelope("Imu imu = 1;").replace("  oneof", "  reserved 2;\n  oneof")
    repository.commit("Close it", {_FILE: closed})
    _, out, _ = run("lint", "--history", _written(repository), *_TREE, "--format", "json")
    assert [one["message"].endswith("today it is reserved") for one in _found(out)] == [True]


def test_a_message_that_changed_its_package_is_found_once(repository: RepositoryBuilder, run: Run) -> None:
    """Under the name that it has today; where it is gone, under one of those that it had."""
    repository.commit("Measure the wind", {_FILE: _envelope("Imu imu = 1;", "Wind wind = 2;")})
    text = _envelope("Imu imu = 1;", "Wind wind = 2;").replace("message PB", "package rover;\nmessage PB")
    repository.commit("Have a package", {_FILE: text})
    root = _written(repository)
    _, out, _ = run("lint", "--history", root, *_TREE, "--format", "json")
    (found,) = (one for one in _found(out) if one["id"] == "HIS101")
    assert (found["message_type"], found["number"]) == ("rover.PBEnvelope", 2)
    assert "was given to 'wind' (Wind)" in found["message"]
    for file in root.rglob("*.proto"):
        file.unlink()
    _, out, _ = run("lint", "--history", root, *_TREE, "--format", "json")
    assert [one["message_type"] for one in _found(out) if one["id"] == "HIS101"] == ["rover.PBEnvelope"]


def test_a_mere_rename_and_a_replaced_content_are_other_rules(repository: RepositoryBuilder, run: Run) -> None:
    """A payload renamed with its fields is a hint; one whose fields were replaced under its name an error."""
    renamed = _PAYLOADS["components/imu.proto"].replace("message Imu", "message ImuInfo")
    files = {_FILE: _envelope("ImuInfo imu = 1;", "Gps gps = 2;"), "components/imu.proto": renamed}
    repository.commit("Rename the IMU", files)
    gps = message("Gps", "string sentence", "bytes almanac", "bool differential", "sint32 leap")
    repository.commit("Replace the GPS", {"components/gps.proto": gps})
    _, out, _ = run("lint", "--history", _written(repository), *_TREE, "--format", "json")
    of_envelope = {one["name"]: one for one in _found(out) if one["message_type"] == "PBEnvelope"}
    assert {name: (one["number"], one["severity"]) for name, one in of_envelope.items()} == {
        "payload-renamed": (1, "hint"),
        "payload-content-replaced": (2, "error"),
    }


def test_states_with_errors_are_read_and_said_to_be_doubtful(repository: RepositoryBuilder, run: Run) -> None:
    """A state with conflict markers counts; the declaration that only this state has is said to be doubtful."""
    conflict = _envelope("Imu imu = 1;", "<<<<<<< HEAD", "Gps gps = 2;", "=======", "Wind wind = 2;", ">>>>>>> side")
    repository.commit("Merge badly", {_FILE: conflict})
    repository.commit("Mend it", {_FILE: _envelope("Imu imu = 1;", "Gps gps = 2;")})
    code, out, _ = run("lint", "--history", _written(repository), *_TREE, "--format", "json")
    assert code == 1
    (found,) = _found(out)
    assert found["message"] == (
        "number 2 of 'PBEnvelope' was given to 'gps' (Gps) and 'wind' (Wind) by one commit: "
        "'Wind' has 0 of the 3 fields of 'Gps'"
    )
    doubts = {use["name"]: use["doubt"] for use in found["history"]}
    assert doubts == {"gps": None, "wind": "it was only read from files with syntax errors"}


def test_what_a_terminal_would_obey_is_not_repeated(repository: RepositoryBuilder, run: Run) -> None:
    """A subject line with control characters colours no terminal, and breaks no report."""
    repository.commit("Measure \x1b[31mthe\x01 wind", {_FILE: _envelope("Imu imu = 1;", "Wind wind = 2;")})
    root = _written(repository)
    _, out, _ = run("lint", "--history", root, *_TREE, "--format", "junit")
    assert "Measure \ufffd[31mthe\ufffd wind" in "".join(ElementTree.fromstring(out).itertext())  # noqa: S314  # ours
    _, out, _ = run("lint", "--history", root, *_TREE)
    assert all(line.isprintable() for line in out.splitlines())


@settings(max_examples=8, suppress_health_check=list(HealthCheck))
@given(st.lists(st.permutations([3, 4, 5, 6]), min_size=1, max_size=6))
def test_a_history_without_reuse_gives_nothing(
    tmp_path_factory: pytest.TempPathFactory, states: list[list[int]]
) -> None:
    """Payloads that come and go, each with a number of its own for ever, are no finding."""
    repository = RepositoryBuilder(tmp_path_factory.mktemp("protos") / "repository")
    payloads = {f"p{number}.proto": message(f"P{number}", f"float value_{number}") for number in range(3, 7)}
    imports = "".join(f'import "{path}";\n' for path in payloads)
    for numbers in [*states, [3, 4, 5, 6]]:
        text = envelope(*(f"P{number} p_{number} = {number};" for number in sorted(numbers[:3])))
        text = text.replace("oneof", f"reserved {numbers[3]};\n  oneof", 1)
        repository.commit("Change", {_FILE: text.replace("\n\n", f"\n\n{imports}\n", 1), **payloads})
    assert main(["lint", "--history", str(_written(repository)), *_TREE]) == 0


def test_against_a_branch_makes_its_own_old_cases_hints(repository: RepositoryBuilder, run: Run) -> None:
    """A tree without a table, whose past nobody can accept, passes; a case that the change adds is an error."""
    repository.commit("Drop the GPS", {_FILE: _envelope("Imu imu = 1;")})
    repository.commit("Measure the wind", {_FILE: _envelope("Imu imu = 1;", "Wind wind = 2;")})
    repository.branch("base")
    root = _written(repository)
    assert run("lint", "--history", root, *_TREE)[0] == 1
    code, out, _ = run("lint", "--history", root, *_TREE, "--against", "base", "--format", "json")
    assert (code, [(one["id"], one["severity"]) for one in _found(out)]) == (0, [("HIS101", "hint")])
    # The number gets a third meaning.
    repository.commit("Drop the wind", {_FILE: _envelope("Imu imu = 1;")})
    repository.commit("Find the place", {_FILE: _envelope("Imu imu = 1;", "Imu second = 2;")})
    root = _written(repository)
    code, out, _ = run("lint", "--history", root, *_TREE, "--against", "base", "--format", "json")
    assert code == 1
    assert ("HIS101", "error") in [(one["id"], one["severity"]) for one in _found(out)]


def test_content_replaced_since_the_branch_is_an_error(repository: RepositoryBuilder, run: Run) -> None:
    """A message that keeps its name has one meaning by name; its new content counts as new all the same."""
    repository.branch("base")
    repository.commit("Replace it", {"components/gps.proto": message("Gps", "string a", "bytes b", "bool c")})
    code, out, _ = run("lint", "--history", _written(repository), *_TREE, "--against", "base", "--format", "json")
    assert code == 1
    assert ("HIS103", "error") in [(one["id"], one["severity"]) for one in _found(out)]


# --- what limits how deep one can look ---------------------------------------------------------------------------


def test_a_shallow_clone_says_how_deep_it_could_look(repository: RepositoryBuilder, tmp_path: Path, run: Run) -> None:
    """The part that is there is looked at; that it is a part is a warning with its depth and the cure."""
    repository.commit("Measure the wind", {_FILE: _envelope("Imu imu = 1;", "Wind wind = 2;")})
    root = _written(repository)
    git(tmp_path, "clone", "--quiet", "--depth", "1", f"file://{root}", "shallow")
    code, out, _ = run("lint", "--history", tmp_path / "shallow", *_TREE, "--format", "json")
    assert code == 1
    assert [(one["id"], one["severity"]) for one in _found(out)] == [("STA106", "warning")]
    assert 'its history goes back only 1 commit",' in out
    assert "git fetch --unshallow" in out


def test_an_empty_repository_and_none_at_all(tmp_path: Path, run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing to look at is exit code 2 with the reason, never a clean bill."""
    monkeypatch.setenv("GIT_CEILING_DIRECTORIES", str(tmp_path))
    (tmp_path / "empty").mkdir()
    (tmp_path / "none").mkdir()
    git(tmp_path / "empty", "init", "--quiet")
    code, out, _ = run("lint", "--history", tmp_path / "empty", *_TREE)
    assert (code, "STA103" in out) == (2, True)
    code, out, _ = run("lint", "--history", tmp_path / "none", *_TREE)
    assert (code, "fatal[STA105] the history cannot be read" in out) == (2, True)


def test_a_tree_whose_protos_are_gone_still_has_a_history(repository: RepositoryBuilder, run: Run) -> None:
    """Deleting everything does not hide what was there."""
    repository.commit("Measure the wind", {_FILE: _envelope("Imu imu = 1;", "Wind wind = 2;")})
    repository.commit("Away with it", dict.fromkeys((_FILE, *_PAYLOADS)))
    code, out, _ = run("lint", "--history", _written(repository), *_TREE, "--format", "json")
    assert code == 1
    assert [(one["number"], "today 'PBEnvelope' does not exist" in one["message"]) for one in _found(out)] == [
        (2, True)
    ]


@pytest.mark.parametrize(
    "arguments", [["lint", "--branches"], ["lint", "--pins", "pins.txt"], ["next-number"], ["history", "1"]]
)
def test_a_question_about_the_envelope_needs_one(
    repository: RepositoryBuilder, run: Run, arguments: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without an envelope there is no answer, and with one that never was neither: exit code 2, not a clean bill."""
    monkeypatch.chdir(_written(repository))
    Path("pins.txt").write_text("rover main\n")
    first, *rest = arguments
    number = [rest.pop()] if rest == ["1"] else []
    for named in ([], ["--message", "Nobody"]):
        code, *said = run(first, *number, ".", *named, *rest)
        # What the lint finds is its output; the other commands have another one.
        found, other = said if first == "lint" else reversed(said)
        assert (code, other, "fatal[STA104]" in found) == (2, "", True)
    code, out, _ = run("lint", "--history", ".", "--message", "Nobody")
    assert (code, "no message 'Nobody' is declared" in out) == (2, True)


# --- branches, pins, numbers -------------------------------------------------------------------------------------


def test_branches_that_took_one_number(repository: RepositoryBuilder, run: Run) -> None:
    """The collision is found before the merge, with both branches, and a number that neither has."""
    repository.branch("wind")
    repository.branch("imu")
    repository.commit("Wind", {_FILE: _envelope("Imu imu = 1;", "Gps gps = 2;", "Wind wind = 3;")}, branch="wind")
    repository.commit("IMU", {_FILE: _envelope("Imu imu = 1;", "Gps gps = 2;", "Imu spare = 3;")}, branch="imu")
    root = _written(repository)
    code, out, _ = run("lint", root, "--branches", *_TREE, "--format", "json")
    assert code == 1
    (found,) = _found(out)
    assert (found["id"], found["number"]) == ("HIS104", 3)
    assert "is 'spare' (Imu) on the branch imu and 'wind' (Wind) on the branch wind" in found["message"]
    assert [(use["declaration"], use["line"], use["today"]) for use in found["history"]] == [
        ("Imu spare = 3;", 11, "on the branch imu"),
        ("Wind wind = 3;", 11, "on the branch wind"),
    ]
    assert found["help"] == "keep the number for one of them, and give the other one the number 4, which no branch uses"
    assert run("lint", root, *_TREE)[0] == 0


def test_branches_that_gave_one_number_to_one_type(repository: RepositoryBuilder, run: Run) -> None:
    """Two new payloads are two, though of one type; one that both branches renamed is not."""
    repository.branch("rear")
    repository.branch("front")
    repository.commit("Rear", {_FILE: _envelope("Imu imu_a = 1;", "Gps gps = 2;", "Imu rear = 3;")}, branch="rear")
    repository.commit("Front", {_FILE: _envelope("Imu imu_b = 1;", "Gps gps = 2;", "Imu front = 3;")}, branch="front")
    code, out, _ = run("lint", _written(repository), "--branches", *_TREE, "--format", "json")
    assert code == 1
    assert [(one["number"], one["message"]) for one in _found(out)] == [
        (3, "number 3 of 'PBEnvelope' is 'front' (Imu) on the branch front and 'rear' (Imu) on the branch rear")
    ]


def _consumer(folder: Path, **files: str) -> Path:
    folder.mkdir()
    for name, text in files.items():
        (folder / name.replace("_", ".", 1)).write_text(text)
    return folder


def _matrix(text: str) -> list[str]:
    """Return the first line of each row of the matrix, with single spaces."""
    lines = [" ".join(line.split()) for line in text.splitlines()]
    return [line for line in lines if re.fullmatch(r"\d+ .*(same|compatible|doubtful \d+|misread \d+)", line)]


def test_pins_that_disagree(repository: RepositoryBuilder, tmp_path: Path, run: Run) -> None:
    """A submodule, CMake's GIT_TAG and a plain list: a number that two commits use differently is one finding."""
    repository.commit("Measure the wind", {_FILE: _envelope("Imu imu = 1;", "Wind wind = 2;")})
    root = _written(repository)
    new, old = git(root, "rev-parse", "HEAD").strip(), git(root, "rev-parse", "HEAD~1").strip()
    rover = _consumer(tmp_path / "rover", gitmodules="")
    (rover / "gitmodules").rename(rover / ".gitmodules")
    git(rover, "init", "--quiet")
    git(rover, "update-index", "--add", "--cacheinfo", f"160000,{old},protos")
    identity = ("-c", "user.name=A", "-c", "user.email=a@example.com")
    git(rover, *identity, "commit", "--quiet", "--message", "Pin")
    declared = f"FetchContent_Declare(protos\n  GIT_REPOSITORY x\n  GIT_TAG {new})  # GIT_TAG {old}\n"
    board = _consumer(tmp_path / "board")
    (board / "CMakeLists.txt").write_text(f"{declared}FetchContent_Declare(other GIT_TAG v9.9)\n")
    (tmp_path / "pins.txt").write_text(f"# who uses what\nbasestation {old[:12]}\n")
    sources = (rover, board, tmp_path / "pins.txt")
    code, out, _ = run("lint", root, *_TREE, "--format", "json", "--pins", *sources)
    assert code == 1
    said = {one["message"] for one in _found(out)}
    assert said == {
        "number 2 of 'PBEnvelope' is `Gps gps = 2;` in 'rover/protos' and 'basestation', "
        "but `Wind wind = 2;` in this checkout and 'board/protos'"
    }
    (found,) = _found(out)
    assert found["path"] == _FILE
    pins = {Path(one["path"]).name: one["text"] for one in found["also"]}
    assert pins["CMakeLists.txt"] == f"'board/protos' is pinned to {new[:10]} 2026-02-04 Measure the wind"
    assert pins[".gitmodules"] == f"'rover/protos' and 'basestation' are pinned to {old[:10]} 2026-02-03 Begin"
    _, text, _ = run("lint", root, *_TREE, "--pins", *sources)
    assert _matrix(text) == [
        "1 rover/protos, same misread 1",
        "2 this checkout, misread 1 same",
    ]


def test_pins_of_a_renamed_package(repository: RepositoryBuilder, tmp_path: Path, run: Run) -> None:
    """A package hides neither the envelope nor types that no file declares; uses of a scalar differ by their names."""
    text = _envelope("Imu imu = 1;", "Gps gps = 2;", "uint32 timeout = 3;")
    repository.commit("Time out", {_FILE: text})
    text = _envelope("rover.Imu imu = 1;", ".rover.Wind wind = 2;", "uint32 temperature = 3;")
    repository.commit("Have a package", {_FILE: text.replace("message PB", "package rover;\nmessage PB")})
    root = _written(repository)
    (tmp_path / "pins.txt").write_text("rover main~1\nbasestation main\n")
    _, out, _ = run("lint", "--history", root, "--message", "PBEnvelope", "--pins", tmp_path / "pins.txt")
    for number, before, today in (
        (2, "Gps gps", "Wind wind"),
        (3, "uint32 timeout", "uint32 temperature"),
    ):
        said = f"`{before} = {number};` in 'rover', but `{today} = {number};` in this checkout and 'basestation'"
        assert f"number {number} of 'rover.PBEnvelope' is {said}" in out
    assert "number 1 of 'rover.PBEnvelope' is" not in out


def test_pins_in_variables(repository: RepositoryBuilder, tmp_path: Path, run: Run) -> None:
    """What CMake's `set` makes of a tag is what counts; a `#` in a string begins no comment."""
    repository.commit("Measure the wind", {_FILE: _envelope("Imu imu = 1;", "Wind wind = 2;")})
    root = _written(repository)
    board = _consumer(tmp_path / "board")
    declared = 'FetchContent_Declare(protos GIT_REPOSITORY "x#y" GIT_TAG ${PROTOS_TAG})'
    (board / "CMakeLists.txt").write_text(f'set(PROTOS_TAG "main" CACHE STRING "of the protos")\n{declared}\n')
    (tmp_path / "pins.txt").write_text("rover main~1\n")
    code, out, _ = run("lint", root, *_TREE, "--pins", board, tmp_path / "pins.txt")
    assert code == 1
    assert (
        "number 2 of 'PBEnvelope' is `Gps gps = 2;` in 'rover', "
        "but `Wind wind = 2;` in this checkout and 'board/protos'" in out
    )


@pytest.mark.parametrize(
    ("address", "said"),
    [
        (
            "https://example.com/team/protos.git",
            "the project 'board/x' is pinned to '0123abc', which this repository does not have",
        ),
        ("https://example.com/json.git", "none of the pins here is a commit of this repository: board/x (0123abc)"),
    ],
)
def test_consumers_of_which_nothing_is_known(
    repository: RepositoryBuilder, tmp_path: Path, run: Run, address: str, said: str
) -> None:
    """A consumer that is pinned to a commit nobody fetched is not one that agrees."""
    root = _written(repository)
    board = _consumer(tmp_path / "board")
    (board / "CMakeLists.txt").write_text(f"FetchContent_Declare(x GIT_REPOSITORY {address} GIT_TAG 0123abc)\n")
    code, out, _ = run("lint", root, *_TREE, "--pins", board)
    assert (code, f"fatal[PIN101] {said}" in out) == (2, True)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (
            "rover 0123456789abcdef\n",
            "the project 'rover' is pinned to '0123456789abcdef', which this repository does not have",
        ),
        ("one two three four\n", "the line 'one two three four' is not a name and a commit, such as `rover 4f1c2ab`"),
        ("# nothing\n", "the file or folder contains no pin"),
        ("rover \0\n", "the file is binary, and not a list of pins"),
        ("rover empty\n", "the project 'rover' is pinned to 'empty', which has no message 'PBEnvelope'"),
    ],
)
def test_pins_that_cannot_be_read(
    repository: RepositoryBuilder, tmp_path: Path, run: Run, text: str, said: str
) -> None:
    """A commit that is not there or has no envelope, a line or a source that says nothing: named, with exit code 2."""
    repository.commit("Begin elsewhere", {"README.md": "Nothing."}, branch="empty", parents=[])
    root = _written(repository)
    (tmp_path / "pins.txt").write_text(text)
    code, out, _ = run("lint", root, *_TREE, "--pins", tmp_path / "pins.txt")
    assert code == 2
    assert f"fatal[PIN101] {said}" in out


def test_the_next_number_skips_whatever_was_used(repository: RepositoryBuilder, run: Run) -> None:
    """No number of the history, of another branch, of a reserved range or a comment is offered; it is said why."""
    repository.commit("Try 3", {_FILE: _envelope("Imu imu = 1;", "Gps gps = 2;", "Wind wind = 3;")})
    repository.branch("side")
    repository.commit("Take 4", {_FILE: _envelope("Imu imu = 1;", "Imu other = 4;")}, branch="side")
    text = _envelope("Imu imu = 1;", "Gps gps = 2;", "// Wind later = 5;").replace("  oneof", "  reserved 6;\n  oneof")
    repository.commit("Go on", {_FILE: text})
    code, out, err = run("next-number", _written(repository), *_TREE)
    assert (code, out) == (0, "7\n")
    lines = err.splitlines()
    assert [line.split()[0] for line in lines] == ["3", "4", "5", "6"]
    assert "was 'wind' (Wind) until" in lines[0]
    assert "is 'other' (Imu) on the branch side" in lines[1]
    assert "comment" in lines[2]
    assert "is reserved in" in lines[3]


def test_the_next_number_skips_what_is_closed(repository: RepositoryBuilder, run: Run) -> None:
    """Ranges are skipped as a whole, and said in one line; where all above is closed, what is left below is taken."""
    closed = "  extensions 3 to 9;\n  reserved 12 to max;\n  uint32 outside = 10;\n  oneof"
    text = _envelope("Imu imu = 1;", "Gps gps = 2;").replace("proto3", "proto2").replace("  oneof", closed)
    repository.commit("Close", {_FILE: text.replace("uint32 outside", "optional uint32 outside")})
    root = _written(repository)
    code, out, err = run("next-number", root, *_TREE)
    assert (code, out) == (0, "11\n")
    assert err.splitlines()[0] == f"3 to 9 is for extensions in {_FILE}"
    (root / _FILE).write_text((root / _FILE).read_text().replace("12 to max", "11 to max"))
    shutil.rmtree(root / ".git")
    code, out, err = run("next-number", root, *_TREE)
    assert (code, out, "no number is left" in err) == (2, "", True)
    (root / _FILE).write_text((root / _FILE).read_text().replace("3 to 9", "4 to 9"))
    assert run("next-number", root, *_TREE)[:2] == (0, "3\n")


def test_the_next_number_says_how_far_it_could_look(repository: RepositoryBuilder, tmp_path: Path, run: Run) -> None:
    """A shallow clone, an envelope that does not compile: the number may not be the last word."""
    repository.commit("Go on", {"README.md": "Nothing."})
    git(tmp_path, "clone", "--quiet", "--depth", "1", f"file://{_written(repository)}", "shallow")
    root = tmp_path / "shallow"
    (root / _FILE).write_text((root / _FILE).read_text().replace("Gps gps = 2;", "Gps gps = 2; Imu other = 3"))
    for arguments in (["next-number", root], ["history", "2", root]):
        _, _, err = run(*arguments, *_TREE)
        assert "warning[STA106] this is a shallow clone" in err
        assert "error[PRO101]" in err
    assert run("next-number", root, *_TREE)[1] == "4\n"


def test_the_life_of_one_number(repository: RepositoryBuilder, run: Run) -> None:
    """What it stood for, from which commit to which; and exit code 1 for a number that never was."""
    repository.commit("Measure the wind", {_FILE: _envelope("Imu imu = 1;", "Wind wind = 2;")})
    root = _written(repository)
    code, out, _ = run("history", "2", root, *_TREE)
    assert code == 0
    assert [line.split(" ", 4)[-1] if line[0] == " " else line for line in out.splitlines()][0::3][:1] == ["Gps gps"]
    assert "Begin (components/common/envelope.proto:10)" in out
    assert out.endswith("  exists on the branch main\n")
    code, out, _ = run("history", "9", root, *_TREE)
    assert (code, out) == (1, "PBEnvelope never used the number 9 in 2 commits\n")


# --- accepting ---------------------------------------------------------------------------------------------------


@pytest.fixture
def project(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A repository with the table and the protos of this one, in whose past two numbers were something else."""
    folder = tmp_path / "project"
    folder.mkdir()
    for name in ("mapping.yaml", "proto"):
        source = ROOT / name
        shutil.copytree(source, folder / name) if source.is_dir() else shutil.copy(source, folder)
    monkeypatch.chdir(folder)
    git(folder, "init", "--quiet", "--initial-branch", "main")
    file = folder / "proto" / _FILE
    now = file.read_text()
    file.write_text(
        now.replace("SensorBoardIMUInfo imu_info = 13", "SensorBoardPHInfo old_ph = 13; SensorBoardPHInfo x = 30")
    )
    _commit(folder, "Once")
    file.write_text(now.replace("  }\n}", "    SensorBoardGPSInfo y = 30;\n  }\n}"))
    _commit(folder, "Then")
    file.write_text(now)
    assert main(["generate"]) == 0
    _commit(folder, "Now")
    return folder


def _commit(folder: Path, subject: str) -> None:
    identity = {f"GIT_{who}_{what}": "a@example.com" for who in ("AUTHOR", "COMMITTER") for what in ("NAME", "EMAIL")}
    for command in (["add", "--all"], ["commit", "--quiet", "--message", subject]):
        subprocess.run(
            ["git", *command], cwd=folder, check=True, env={**os.environ, **identity, "GIT_CONFIG_GLOBAL": os.devnull}
        )


def test_what_is_accepted_is_burned_and_not_found_again(project: Path, run: Run) -> None:
    """The ledger takes note, the envelope reserves what is free, and from then on only what is new is found."""
    assert run("lint", "--history")[0] == 1
    code, out, _ = run("lint", "--history", "--accept")
    assert code == 0
    assert "changed mapping.lock" in out
    ledger = (project / "mapping.lock").read_text()
    assert "  PBEnvelope 13: SensorBoardPHInfo old_ph | SensorBoardIMUInfo imu_info now\n" in ledger
    assert "  PBEnvelope 30: SensorBoardPHInfo x | SensorBoardGPSInfo y\n" in ledger
    assert "  reserved 30;  // SensorBoardPHInfo, SensorBoardGPSInfo\n" in (project / "proto" / _FILE).read_text()
    assert run("lint", "--history")[0] == 0
    assert run("generate", "--check")[0] == 0
    assert run("next-number")[1] == "22\n"


def test_a_burned_number_is_given_to_nobody(project: Path, run: Run) -> None:
    """A row that takes one is refused; the payload that had it when it was accepted keeps it."""
    run("lint", "--history", "--accept")
    table = project / "mapping.yaml"
    row = "  - {number: 30, name: again, proto: SensorBoardPHInfo, topic: again, direction: hardware_to_ros}\n"
    table.write_text(table.read_text().replace("\nretired:", f"{row}\nretired:"))
    code, _, err = run("generate")
    assert code == 1
    assert "error[ENV110] field 30 was used for 'x' (SensorBoardPHInfo) and 'y' (SensorBoardGPSInfo) in the past" in err


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["lint", "--message", "PBEnvelope"], "need PROTO_ROOT"),
        (["next-number", "--envelope", "e.proto"], "need PROTO_ROOT"),
        (["lint", "one", "--history", "."], "two folders of .proto files are given, 'one' and '.'"),
        (["lint", ".", "--history", "main", "--accept"], "leave out 'main' after --history"),
    ],
)
def test_words_without_effect(run: Run, arguments: list[str], said: str) -> None:
    """What would not be looked at is not taken without a word."""
    code, out, err = run(*arguments)
    assert (code, out, said in err) == (2, "", True)


def test_accepting_needs_the_history(project: Path, run: Run) -> None:
    """Nothing is accepted where nobody asked what there is."""
    for question in ([], ["--branches"]):
        code, out, _ = run("lint", *question, "--accept")
        assert (code, "fatal[RET102]" in out) == (2, True)


# --- what is not committed yet, and other states ------------------------------------------------------------------


@pytest.fixture
def root(repository: RepositoryBuilder) -> Path:
    """A checked-out tree whose envelope lost its number 2."""
    repository.commit("Take GPS away", {_FILE: _envelope("Imu imu = 1;")})
    return _written(repository)


@pytest.mark.parametrize("against", [(), ("--against", "HEAD")])
def test_a_reuse_is_found_before_the_commit(root: Path, run: Run, against: tuple[str, ...]) -> None:
    """What is only written on disk is an error at its line; before it was written, there was nothing."""
    _, out, _ = run("lint", "--history", root, *_TREE, *against, "--format", "json")
    assert [one["id"] for one in _found(out)] == ["ENV107"]
    (root / _FILE).write_text(_envelope("Imu imu = 1;", "Wind wind = 2;"))
    code, out, _ = run("lint", "--history", root, *_TREE, *against, "--format", "json")
    (found,) = (one for one in _found(out) if one["id"] == "HIS101")
    assert (code, found["severity"], found["number"]) == (1, "error", 2)
    gps, wind = found["history"]
    assert (wind["first_commit"], wind["today"]) == (None, "in the working tree, not committed yet")
    assert (gps["first_subject"], gps["last_subject"]) == ("Begin", "Take GPS away")
    assert (root / wind["path"]).is_file()


@pytest.mark.slow
def test_a_hook_refuses_the_commit_of_a_reuse(root: Path) -> None:
    """The hook looks at the index: what is not staged does not matter, neither a reuse nor its correction."""
    good = _envelope("Imu imu = 1;").replace("{\n", "{\n  reserved 2;\n", 1)
    bad = _envelope("Imu imu = 1;", "Wind wind = 2;")
    (root / _FILE).write_text(good)
    hook = root / ".git" / "hooks" / "pre-commit"
    command = shlex.join([sys.executable, "-m", "roverlink", "lint", ".", *_TREE, "--history"])
    hook.write_text(f"#!/bin/sh\n{command} >&2\n")
    hook.chmod(0o755)
    (root / "README.md").write_text("Text.")
    git(root, "add", "--all")
    (root / _FILE).write_text(bad)
    commit = ("-c", "user.name=A", "-c", "user.email=a@example.com", "commit", "--quiet", "--message", "Change")
    git(root, *commit)
    with pytest.raises(
        AssertionError, match=r"(?s)number 2 of 'PBEnvelope' was given to 'wind'.*give 'wind' the number 3"
    ):
        git(root, *commit, "--all")
    git(root, "add", "--all")
    (root / _FILE).write_text(good)
    with pytest.raises(AssertionError, match=r"now in the index, not committed yet"):
        git(root, *commit)
    (root / _FILE).write_text(_envelope("Wind wind = 3;"))
    git(root, "add", "--all")
    (root / _FILE).write_text(good)
    with pytest.raises(AssertionError, match=r"error.ENV107. field 1, 'imu'"):
        git(root, *commit)


def test_another_state_that_is_not_there(root: Path, run: Run) -> None:
    """A word that names neither a folder nor a ref is the only finding."""
    code, out, err = run("lint", root, "--history", "nowhere")
    assert (code, "fatal[STA101] 'nowhere' is not a folder, a file, or a git ref" in out, err) == (2, True, "")


def test_the_history_of_another_state(repository: RepositoryBuilder, run: Run) -> None:
    """`--history REF` checks the files of the ref, and no commit that was built upon it."""
    repository.commit("Take GPS away", {_FILE: _envelope("Imu imu = 1;")})
    repository.branch("release")
    repository.commit("Measure the wind", {_FILE: _envelope("Imu imu = 1;", "Wind wind = 2;")})
    root = _written(repository)
    _, out, _ = run("lint", root, *_TREE, "--history", "release", "--format", "json")
    assert [one["id"] for one in _found(out)] == ["ENV107"]
    code, out, _ = run("lint", root, *_TREE, "--history", "main", "--format", "json")
    assert (code, [one["number"] for one in _found(out)]) == (1, [2])
    (root / _FILE).write_text(_envelope("Imu imu = 1;"))
    assert run("lint", root, *_TREE, "--history", "main")[0] == 1
