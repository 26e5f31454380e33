"""What the lint, `history` and `number next` say if a name, a folder or a place on the command line is not right."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest
from repositories import RepositoryBuilder, git

_ENV = """\
syntax = "proto3";
package rover;
message Imu { float heading = 1; }
message Gps { double lat = 1; double lon = 2; }
message Motor { float speed = 1; int32 gear = 2; }
message Env { oneof payload { Imu imu = 1; Gps gps = 2; Motor motor = 3; } }
"""

Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def repository(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A repository with the folder `protos`, from which the payload Gps was removed. It is the current folder."""
    built = RepositoryBuilder(tmp_path / "repository")
    built.commit("Begin", {"protos/env.proto": _ENV})
    without = _ENV.replace(" Gps gps = 2;", "").replace("message Gps { double lat = 1; double lon = 2; }\n", "")
    built.commit("Remove the GPS", {"protos/env.proto": without})
    monkeypatch.chdir(built.write())
    return built.root


# --- names ---


@pytest.mark.parametrize(
    ("named", "code", "first"),
    [
        ("Env:2", 0, "Gps gps"),  # the envelope does not have to be named
        ("rover.Env:2", 0, "Gps gps"),
        ("Gps:2", 0, "double lon"),  # only earlier commits declare it
        ("Gps:3", 1, "Gps never used the number 3 in 2 commits"),
    ],
)
def test_history_takes_a_number_of_any_message(repository: Path, run: Run, named: str, code: int, first: str) -> None:
    """`history` takes `TYPE:NUMBER`, as `--accept` does; a number that the type never had is exit code 1."""
    exit_code, out, _ = run("number", "history", named, "protos")
    assert (exit_code, out.splitlines()[0]) == (code, first)


@pytest.mark.parametrize(
    ("named", "hint"),
    [
        ("Moter:2", "did you mean 'rover.Motor'?"),
        ("rover.gsp:1", "did you mean 'rover.Gps'?"),
        ("Xyzzy:1", "known: rover.Env, rover.Gps, rover.Imu, rover.Motor"),
    ],
)
def test_history_of_an_unknown_type_is_an_error(repository: Path, run: Run, named: str, hint: str) -> None:
    """A type that no commit declares cannot be answered with "never used": the similar names are suggested."""
    name = named.partition(":")[0]
    expected = f"roverlink: no commit and no file declares a message or enum {name!r}; {hint}\n"
    assert run("number", "history", named, "protos") == (2, "", expected)


@pytest.mark.parametrize(
    ("command", "help"),
    [
        (("lint", "protos", "--message", "env"), "use --message rover.Env"),
        (("lint", "protos", "--message", "Envelope"), "use --message rover.Env"),
        (("lint", "protos", "--message", "Moter"), "use --message rover.Motor"),
        (("lint", "protos", "--message", "other.Env"), "use --message rover.Env"),
        (("number", "history", "2", "protos", "--message", "Envelope"), "use --message rover.Env"),
        (("number", "history", "2", "protos", "--message", "Gbs"), "use --message rover.Gps"),
        (("number", "next", "protos"), "use --message rover.Env"),
        (("lint", "protos", "--branches"), "use --message rover.Env"),
        (("lint", "protos", "--pins", "pins.txt"), "use --message rover.Env"),
        (("lint", "protos", "--history", "--message", "Moter"), "use --message rover.Motor"),
        (("lint", "protos", "--envelope", "no.proto", "--message", "rover.Env"), "use --envelope env.proto"),
    ],
)
def test_an_envelope_is_suggested(repository: Path, run: Run, command: tuple[str, ...], help: str) -> None:
    """If the envelope is unknown, its help names the messages with similar names, or else those with a oneof."""
    code, out, err = run(*command)
    assert (code, "fatal[STA104]" in out + err) == (2, True)
    assert f"  help: {help}\n" in out + err


@pytest.mark.slow
def test_next_number_says_if_the_message_has_no_oneof(repository: Path, run: Run) -> None:
    """A message without a oneof may be the wrong one, so it is said that all its fields count."""
    assert run("number", "next", "protos", "--message", "Motor") == (
        0,
        "3\n",
        "'rover.Motor' has no oneof, so all its fields count as payloads\n",
    )
    assert "oneof" not in run("number", "next", "protos", "--message", "Env")[2]


# --- folders ---


def test_a_proto_file_in_place_of_its_folder(repository: Path, run: Run) -> None:
    """A .proto file as PROTO_ROOT gives one error, which says that it is a file and names its folder."""
    code, out, _ = run("lint", "protos/env.proto", "--history")
    assert (code, out) == (
        2,
        "protos/env.proto: fatal[STA103] 'protos/env.proto' is a file, not a folder\n"
        "  help: give the folder from which its imports are found, such as 'protos'\n\n1 fatal error\n",
    )


def test_hundreds_of_unreadable_files(tmp_path: Path, run: Run) -> None:
    """From a wrong folder, the text shows some of the files that cannot be read, and asks once; JSON has all."""
    for number in range(25):
        (tmp_path / f"{number}.proto").write_bytes(b"\0")
    code, out, _ = run("lint", tmp_path)
    assert (code, out.count("[PRO102]")) == (2, 20)
    assert "... and 5 more errors PRO102; is this the right folder of .proto files?\n\n25 fatal errors\n" in out
    assert run("lint", tmp_path, "--format", "json")[1].count("PRO102") == 25


@pytest.mark.parametrize(
    ("command", "message"),
    [
        (("lint", "--history"), "fatal[STA105] the history cannot be read: {}"),
        (("number", "history", "2"), "fatal[STA105] the history cannot be read: {}"),
        (
            ("lint", "--against", "main"),
            "fatal[STA101] 'main' is not a folder or a file, and no git ref can be read: {}",
        ),
    ],
)
@pytest.mark.parametrize("cause", ["fatal: not a git repository", "git cannot be run: No such file or directory"])
def test_without_git_the_cause_is_in_the_message(
    tmp_path: Path, run: Run, monkeypatch: pytest.MonkeyPatch, command: tuple[str, ...], message: str, cause: str
) -> None:
    """Outside of a repository, and without an installed git, the message has the cause and the help has the remedy."""
    monkeypatch.setenv("GIT_CEILING_DIRECTORIES", str(tmp_path.parent))
    if "cannot be run" in cause:
        monkeypatch.setenv("PATH", str(tmp_path))
    (tmp_path / "env.proto").write_text(_ENV)
    code, out, err = run(*command, tmp_path, "--message", "Env")
    assert (code, message.format(cause) in out + err) == (2, True)
    assert "  help: install git, and run the command in a clone of the repository\n" in out + err


# --- places in earlier commits ---


@pytest.mark.parametrize(("folder", "option"), [("protos", ("--against", "main~1")), (".", ("--pins", "boards.txt"))])
def test_git_show_takes_the_places_of_earlier_commits(
    repository: Path, run: Run, monkeypatch: pytest.MonkeyPatch, option: tuple[str, ...], folder: str
) -> None:
    """A place in another commit starts at the top of the repository, so that `git show COMMIT:PATH` prints the file."""
    env = Path("protos/env.proto")
    env.write_text(env.read_text().replace("Motor motor = 3;", "Imu other = 3;"))
    if folder == ".":
        monkeypatch.chdir("protos")
    Path("boards.txt").write_text("rover main~1\n")
    out = run("lint", folder, "--message", "Env", *option)[1]
    places = set(re.findall(r"^  (\S+:\S+\.proto):\d+:\d+: ", out, re.MULTILINE))
    assert places
    assert {git(repository, "show", place) for place in places} == {_ENV}
