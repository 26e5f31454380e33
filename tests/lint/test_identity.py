"""Messages and enums over time: when the history takes two declarations for one type, and when for two."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from repositories import RepositoryBuilder, envelope, git, message

from roverlink.generator.lint.history import History, read_history

XYZ = ("float north", "float east", "float height")
POSE = message("Pose", *XYZ, "int32 frame_id")
WITHOUT_Z = message("Pose", "float north", "float east", "int32 frame_id = 4;")
REUSED = message("Pose", "float north", "float east", "string label_text = 3;", "int32 frame_id = 4;")


@pytest.fixture
def repository(tmp_path: Path) -> RepositoryBuilder:
    """A repository without commits."""
    return RepositoryBuilder(tmp_path / "repository")


def _reused(history: History) -> set[tuple[str, int]]:
    return {(one.owner, one.number) for type in history.types for one in history.reuses_of(type.id) if one.certain}


def _in_package(text: str, package: str) -> str:
    return text.replace("\n\n", f"\n\npackage {package};\n\n", 1)


def _renamed(text: str, name: str) -> str:
    return text.replace("message Pose", f"message {name}")


def _nested(text: str) -> str:
    head, _, body = text.partition("message")
    return f"{head}message Robot {{ message{body}}}\n"


def _moved_file(text: str) -> dict[str, str | None]:
    return {"pose.proto": None, "common/pose_types.proto": text}


@pytest.mark.parametrize(
    ("change", "today"),
    [
        (lambda text: {"pose.proto": text}, "Pose"),
        (_moved_file, "Pose"),
        (lambda text: {"pose.proto": _in_package(text, "rover")}, "rover.Pose"),
        (lambda text: _moved_file(_in_package(text, "rover")), "rover.Pose"),
        (lambda text: {"pose.proto": _renamed(text, "Placement")}, "Placement"),
        (lambda text: _moved_file(_renamed(_in_package(text, "rover"), "Placement")), "rover.Placement"),
        (lambda text: {"pose.proto": _nested(text)}, "Robot.Pose"),
    ],
)
def test_what_a_commit_does_to_a_type_hides_no_reuse(
    repository: RepositoryBuilder, change: Callable[[str], dict[str, str | None]], today: str
) -> None:
    """A number is lost, the type is moved, renamed or nested, and the number is given away: that is a reuse."""
    repository.commit("Begin", {"pose.proto": POSE})
    repository.commit("Lose z", {"pose.proto": WITHOUT_Z})
    repository.commit("Change", change(WITHOUT_Z))
    repository.commit("Reuse", change(REUSED))
    assert _reused(read_history(repository.write())) == {(today, 3)}


@pytest.mark.parametrize("rename", [lambda text: text, lambda text: text.replace("PBEnvelope", "Env")])
def test_a_renamed_envelope_keeps_its_burned_numbers(
    repository: RepositoryBuilder, rename: Callable[[str], str]
) -> None:
    """One payload is enough to recognize an envelope that got another name."""
    types = message("Imu", "float north") + "message Gps { double lat = 1; }\nmessage Wind { string text = 1; }\n"
    repository.commit("Begin", {"e.proto": envelope("Imu imu = 1;", "Gps gps = 2;"), "types.proto": types})
    repository.commit("Lose GPS", {"e.proto": envelope("Imu imu = 1;")})
    repository.commit("Rename", {"e.proto": rename(envelope("Imu imu = 1;"))})
    repository.commit("Measure the wind", {"e.proto": rename(envelope("Imu imu = 1;", "Wind wind = 2;"))})
    assert {number for _, number in _reused(read_history(repository.write()))} == {2}


def test_a_package_takes_small_messages_along(repository: RepositoryBuilder) -> None:
    """A message of one field says little by itself; the other messages of its file moved the same way."""
    before = f"{POSE}message Ping {{ uint32 id = 1; string text = 2; }}\n"
    after = _in_package(f"{POSE}message Ping {{ string name = 2; }}\n", "rover")
    repository.commit("Begin", {"a.proto": before})
    repository.commit("Move and change", {"a.proto": None, "rover/a.proto": after})
    repository.commit("Reuse", {"rover/a.proto": after.replace("string name = 2;", "string name = 2; bool busy = 1;")})
    assert _reused(read_history(repository.write())) >= {("rover.Ping", 1)}


def _type(owner: str, *values: str) -> str:
    listed = "".join(f" {value} = {number};" for number, value in enumerate(values))
    return f'syntax = "proto3";\n\nmessage {owner} {{ enum Type {{{listed} }} Type type = 1; }}\n'


@pytest.mark.parametrize(
    "states",
    [
        pytest.param(
            [
                {"x.proto": _type("X", "NONE", "RED", "BLUE")},
                {"x.proto": None},
                {"y.proto": _type("Y", "NONE", "SLOW", "FAST")},
            ],
            id="deleted, and another one of the last name added later",
        ),
        pytest.param(
            [
                {"x.proto": _type("X", "NONE", "RED", "BLUE")},
                {"x.proto": None, "y.proto": _type("Y", "NONE", "SLOW", "FAST")},
            ],
            id="deleted, and another one of the last name added at once",
        ),
        pytest.param(
            [
                {"a.proto": _in_package(POSE, "a")},
                {"b.proto": _in_package(message("Pose", "string room", "bool known"), "b")},
                {"a.proto": None},
                {"b.proto": _in_package(message("Pose", "string room", "bool known", "bytes raw"), "b")},
            ],
            id="of two packages",
        ),
        pytest.param(
            [
                {"a.proto": POSE},
                {"a.proto": None, "b.proto": 'syntax = "proto3";\nenum Pose { STANDING = 0; LYING = 1; SITTING = 3; }'},
            ],
            id="a message and an enum",
        ),
        pytest.param(
            [
                {
                    "proto/pose.proto": POSE,
                    "vendor/pose.proto": message("Pose", "float north", "bytes blob", "bool ok"),
                },
                {"proto/pose.proto": WITHOUT_Z},
                {"vendor/pose.proto": message("Pose", "float north", "bytes blob", "bool ok", "uint64 time")},
            ],
            id="a vendored copy",
        ),
        pytest.param(
            [
                {"old/pose.proto": POSE, "proto/pose.proto": message("Pose", "float north", "bytes blob", "bool ok")},
                {"old/pose.proto": None},
                {"vendor/pose.proto": message("Pose", "string room", "bool known")},
            ],
            id="two copies at different times",
        ),
        pytest.param(
            [
                {"a.proto": POSE},
                {"a.proto": _renamed(POSE, "Placement")},
                {"b.proto": message("Pose", "string room", "bool known", "bytes raw")},
            ],
            id="a renamed one, and a new one of its former name",
        ),
    ],
)
def test_types_that_only_share_a_name_are_unrelated(
    repository: RepositoryBuilder, states: list[dict[str, str | None]]
) -> None:
    """No number is reported that another type of the same name had."""
    for number, files in enumerate(states):
        repository.commit(f"State {number}", files)
    assert _reused(read_history(repository.write())) == set()


def test_a_full_name_that_comes_back_is_the_same_type(repository: RepositoryBuilder) -> None:
    """Deleted with its file, and back in another one: the numbers that it had are still burned."""
    repository.commit("Begin", {"pose.proto": POSE})
    repository.commit("Delete", {"pose.proto": None})
    repository.commit("Put back", {"other.proto": REUSED})
    assert _reused(read_history(repository.write())) == {("Pose", 3)}


def test_a_copy_goes_on_when_the_original_is_deleted(repository: RepositoryBuilder) -> None:
    """A move in two commits, first the copy and then the deletion, keeps the history."""
    repository.commit("Begin", {"pose.proto": POSE})
    repository.commit("Lose z", {"pose.proto": WITHOUT_Z})
    repository.commit("Copy", {"new/pose.proto": WITHOUT_Z})
    repository.commit("Delete", {"pose.proto": None})
    repository.commit("Reuse", {"new/pose.proto": REUSED})
    assert _reused(read_history(repository.write())) == {("Pose", 3)}


# --- merges -----------------------------------------------------------------------------------------------------


def test_a_merge_takes_a_rename_over(repository: RepositoryBuilder) -> None:
    """One side renames a message, the other adds a field to it: after the merge it is one message with both pasts."""
    begin = repository.commit("Begin", {"pose.proto": POSE})
    side = repository.commit("Rename", {"pose.proto": _renamed(WITHOUT_Z, "Placement")}, branch="side", parents=[begin])
    grown = POSE.replace("\n}", "\n  bool fixed = 5;\n}")
    main = repository.commit("Grow", {"pose.proto": grown})
    merged = _renamed(WITHOUT_Z, "Placement").replace("\n}", "\n  bool fixed = 5;\n}")
    repository.commit("Merge", {"pose.proto": merged}, parents=[main, side])
    repository.delete_branch("side")
    repository.commit("Reuse", {"pose.proto": merged.replace("\n}", "\n  string label_text = 3;\n}")})
    history = read_history(repository.write())
    assert _reused(history) == {("Placement", 3)}
    assert history.numbers("Placement")[5][0].came.subject == "Grow"


def test_a_merge_takes_over_that_a_name_has_another_type(repository: RepositoryBuilder) -> None:
    """One side renames a message and gives the name to a new one; the other side does not touch the file."""
    begin = repository.commit("Begin", {"pose.proto": POSE})
    repository.commit("Rename", {"pose.proto": _renamed(POSE, "Placement")}, branch="side", parents=[begin])
    both = _renamed(POSE, "Placement") + "message Pose { string room = 1; bool known = 2; }\n"
    side = repository.commit("Add another", {"pose.proto": both}, branch="side")
    main = repository.commit("Write", {"README.md": "Text."})
    repository.commit("Merge", {"pose.proto": both}, parents=[main, side])
    repository.delete_branch("side")
    repository.commit("Grow", {"pose.proto": both.replace("known = 2;", "known = 2; bytes raw = 3;")})
    history = read_history(repository.write())
    assert _reused(history) == set()
    assert [usage.name for usage in history.numbers("Placement")[4]] == ["frame_id"]


def test_both_sides_add_a_message(repository: RepositoryBuilder) -> None:
    """A message that was picked to another branch is one message after the merge."""
    begin = repository.commit("Begin", {"README.md": "Text."})
    side = repository.commit("Add", {"pose.proto": POSE}, branch="side", parents=[begin])
    main = repository.commit("Pick", {"pose.proto": POSE})
    repository.commit("Merge", parents=[main, side])
    repository.delete_branch("side")
    history = read_history(repository.write())
    assert [type.names for type in history.types] == [("Pose",)]


# --- changes that are not committed yet -------------------------------------------------------------------------


def test_the_working_tree_and_the_index_are_the_newest_states(repository: RepositoryBuilder) -> None:
    """A reuse is found when it is written, when it is staged, and in a file that git does not know yet."""
    repository.commit("Begin", {"pose.proto": POSE})
    repository.commit("Lose z", {"pose.proto": WITHOUT_Z})
    root = repository.write()
    assert _reused(read_history(root)) == set()
    (root / "pose.proto").write_text(REUSED)
    assert _reused(read_history(root)) == {("Pose", 3)}
    git(root, "add", "pose.proto")
    assert _reused(read_history(root)) == {("Pose", 3)}
    git(root, "rm", "--quiet", "--cached", "pose.proto")
    assert _reused(read_history(root)) == {("Pose", 3)}
    (usage,) = (usage for usage in read_history(root).numbers("Pose")[3] if usage.name == "label_text")
    assert str(usage.came) == "a change in the working tree that is not committed yet"
    assert usage.live_at == ("the working tree",)


def test_a_hook_looks_at_the_index(repository: RepositoryBuilder, monkeypatch: pytest.MonkeyPatch) -> None:
    """What is not staged is not part of the commit; `git commit FILE` gives the hook an index of its own."""
    repository.commit("Begin", {"pose.proto": POSE})
    repository.commit("Lose z", {"pose.proto": WITHOUT_Z})
    root = repository.write()
    (root / "pose.proto").write_text(REUSED)
    monkeypatch.setenv("GIT_INDEX_FILE", str(root / ".git" / "index"))
    assert _reused(read_history(root)) == set()
    monkeypatch.delenv("GIT_INDEX_FILE")
    (root / ".git" / "next-index").write_bytes((root / ".git" / "index").read_bytes())
    git(root, "add", "pose.proto")
    monkeypatch.setenv("GIT_INDEX_FILE", str(root / ".git" / "index"))
    assert _reused(read_history(root)) == {("Pose", 3)}
    monkeypatch.setenv("GIT_INDEX_FILE", str(root / ".git" / "next-index"))
    assert _reused(read_history(root)) == set()


def test_another_newest_state(repository: RepositoryBuilder) -> None:
    """A ref is judged without the commits that were built upon it; other branches still count."""
    begin = repository.commit("Begin", {"pose.proto": POSE})
    repository.commit("Lose z", {"pose.proto": WITHOUT_Z})
    repository.branch("release")
    repository.commit("Reuse", {"pose.proto": REUSED})
    repository.commit("Side", {"pose.proto": POSE.replace("float east", "bytes raw")}, branch="side", parents=[begin])
    root = repository.write()
    assert _reused(read_history(root)) == {("Pose", 2), ("Pose", 3)}
    assert _reused(read_history(root, newest="release")) == {("Pose", 2)}
    assert read_history(root, newest="release").commits == 3


def test_a_merge_that_is_not_committed_yet(repository: RepositoryBuilder) -> None:
    """Both sides are the past of the merge that is being made, even with conflicts."""
    begin = repository.commit("Begin", {"pose.proto": POSE})
    repository.branch("side", begin)
    repository.commit("Lose z", {"pose.proto": WITHOUT_Z}, branch="side")
    repository.commit("Change z", {"pose.proto": POSE.replace("float height", "double z")})
    root = repository.write()
    identity = ("-c", "user.name=a", "-c", "user.email=a")
    with pytest.raises(AssertionError):  # git says that there are conflicts
        git(root, *identity, "merge", "side")
    (root / "pose.proto").write_text(WITHOUT_Z)
    history = read_history(root)
    assert [usage.live_at for usage in history.numbers("Pose")[4]] == [("refs/heads/main", "refs/heads/side")]
    assert {
        usage.type: sorted(went.subject for one in usage.intervals for went in one.went)
        for usage in history.numbers("Pose")[3]
    } == {"float": ["Change z", "Lose z"], "double": ["a change in the working tree that is not committed yet"]}
