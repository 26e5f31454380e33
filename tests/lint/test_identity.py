"""Messages and enums over time: when the history takes two declarations for one type, and when for two."""

from __future__ import annotations

import pytest
from repositories import RepositoryBuilder, envelope, git, message

from roverlink.generator.lint.history import History, read_history

XYZ = ("float north", "float east", "float height")
POSE = message("Pose", *XYZ, "int32 frame_id")
WITHOUT_Z = message("Pose", "float north", "float east", "int32 frame_id = 4;")
REUSED = message("Pose", "float north", "float east", "string label_text = 3;", "int32 frame_id = 4;")
_OTHER = message("Pose", "float north", "bytes blob", "bool ok")
_ROOM = message("Pose", "string room", "bool known")
_HOME, _NEW = "pose.proto", "common/pose_types.proto"

States = list[dict[str, str | None]]


def _reused(history: History) -> set[tuple[str, int]]:
    return {(one.owner, one.number) for type in history.types for one in history.reuses_of(type.id) if one.certain}


def _in_package(text: str, package: str = "rover") -> str:
    return text.replace("\n\n", f"\n\npackage {package};\n\n", 1)


def _renamed(text: str) -> str:
    return text.replace("message Pose", "message Placement")


def _nested(text: str) -> str:
    head, _, body = text.partition("message")
    return f"{head}message Robot {{ message{body}}}\n"


def _moved(text: str) -> dict[str, str | None]:
    return {_HOME: None, _NEW: text}


def _link(*members: str, name: str = "PBEnvelope") -> dict[str, str | None]:
    return {"e.proto": envelope(*members).replace("PBEnvelope", name)}


_LOST: States = [{_HOME: POSE}, {_HOME: WITHOUT_Z}]
_SMALL = f"{POSE}message Ping {{ uint32 id = 1; string text = 2; }}\n"
_SMALLER = _in_package(f"{POSE}message Ping {{ string name = 2; }}\n")
_WINDS = message("Imu", "float north") + "message Gps { double lat = 1; }\nmessage Wind { string text = 1; }\n"
_LINKS: States = [_link("Imu imu = 1;", "Gps gps = 2;") | {"types.proto": _WINDS}, _link("Imu imu = 1;")]

_ONE_TYPE: dict[str, tuple[States, str, int]] = {
    "moved and renamed": (
        [*_LOST, _moved(_renamed(_in_package(WITHOUT_Z))), {_NEW: _renamed(_in_package(REUSED))}],
        "rover.Placement",
        3,
    ),
    "nested": ([*_LOST, {_HOME: _nested(WITHOUT_Z)}, {_HOME: _nested(REUSED)}], "Robot.Pose", 3),
    "deleted, and back in another file": ([{_HOME: POSE}, {_HOME: None}, {"other.proto": REUSED}], "Pose", 3),
    "copied, and then deleted": ([*_LOST, {_NEW: WITHOUT_Z}, {_HOME: None}, {_NEW: REUSED}], "Pose", 3),
    # One payload is enough to recognize an envelope that got another name.
    "an envelope": ([*_LINKS, _link("Imu imu = 1;", "Wind wind = 2;")], "PBEnvelope", 2),
    "a renamed envelope": (
        [*_LINKS, _link("Imu imu = 1;", name="Env"), _link("Imu imu = 1;", "Wind wind = 2;", name="Env")],
        "Env",
        2,
    ),
    # A message of one field says little by itself; the other messages of its file moved the same way.
    "a small message of a package": (
        [{_HOME: _SMALL}, _moved(_SMALLER), {_NEW: _SMALLER.replace("name = 2;", "name = 2; bool busy = 1;")}],
        "rover.Ping",
        1,
    ),
}


@pytest.mark.parametrize("case", _ONE_TYPE)
def test_what_a_commit_does_to_a_type_hides_no_reuse(repository: RepositoryBuilder, case: str) -> None:
    """A number is lost, the type is moved, renamed or nested, and the number is given away: that is a reuse."""
    states, today, number = _ONE_TYPE[case]
    found = _reused(read_history(repository.commits(*states).write()))
    assert (today, number) in found
    assert found == {(today, number)} or case == "a small message of a package"


def _type(owner: str, *values: str) -> str:
    listed = "".join(f" {value} = {number};" for number, value in enumerate(values))
    return f'syntax = "proto3";\n\nmessage {owner} {{ enum Type {{{listed} }} Type type = 1; }}\n'


_X, _Y = _type("X", "NONE", "RED", "BLUE"), _type("Y", "NONE", "SLOW", "FAST")
_ENUM = 'syntax = "proto3";\nenum Pose { STANDING = 0; LYING = 1; SITTING = 3; }'
_TWO_TYPES: dict[str, States] = {
    "deleted, and another one of the last name later": [{"x.proto": _X}, {"x.proto": None}, {"y.proto": _Y}],
    "deleted, and another one of the last name at once": [{"x.proto": _X}, {"x.proto": None, "y.proto": _Y}],
    "of two packages": [
        {"a.proto": _in_package(POSE, "a")},
        {"b.proto": _in_package(_ROOM, "b")},
        {"a.proto": None},
        {"b.proto": _in_package(message("Pose", "string room", "bool known", "bytes raw"), "b")},
    ],
    "a message and an enum": [{"a.proto": POSE}, {"a.proto": None, "b.proto": _ENUM}],
    "two copies at different times": [
        {"old/pose.proto": POSE, "proto/pose.proto": _OTHER},
        {"old/pose.proto": None},
        {"vendor/pose.proto": _ROOM},
    ],
    "a renamed one, and a new one of its former name": [
        {"a.proto": POSE},
        {"a.proto": _renamed(POSE)},
        {"b.proto": message("Pose", "string room", "bool known", "bytes raw")},
    ],
}


@pytest.mark.parametrize("case", _TWO_TYPES)
def test_types_that_only_share_a_name_are_unrelated(repository: RepositoryBuilder, case: str) -> None:
    """No number is reported that another type of the same name had."""
    assert _reused(read_history(repository.commits(*_TWO_TYPES[case]).write())) == set()


# --- merges ---


def test_a_merge_takes_a_rename_over(repository: RepositoryBuilder) -> None:
    """One side renames a message, the other adds a field to it: after the merge it is one message with both pasts."""
    begin = repository.commit("Begin", {_HOME: POSE})
    side = repository.commit("Rename", {_HOME: _renamed(WITHOUT_Z)}, branch="side", parents=[begin])
    main = repository.commit("Grow", {_HOME: POSE.replace("\n}", "\n  bool fixed = 5;\n}")})
    merged = _renamed(WITHOUT_Z).replace("\n}", "\n  bool fixed = 5;\n}")
    repository.commit("Merge", {_HOME: merged}, parents=[main, side])
    repository.delete_branch("side")
    repository.commit("Reuse", {_HOME: merged.replace("\n}", "\n  string label_text = 3;\n}")})
    history = read_history(repository.write())
    assert _reused(history) == {("Placement", 3)}
    assert history.numbers("Placement")[5][0].came.subject == "Grow"


def test_a_merge_takes_over_that_a_name_has_another_type(repository: RepositoryBuilder) -> None:
    """One side renames a message and gives the name to a new one; the other side does not touch the file."""
    begin = repository.commit("Begin", {_HOME: POSE})
    repository.commit("Rename", {_HOME: _renamed(POSE)}, branch="side", parents=[begin])
    both = _renamed(POSE) + "message Pose { string room = 1; bool known = 2; }\n"
    side = repository.commit("Add another", {_HOME: both}, branch="side")
    main = repository.commit("Write", {"README.md": "Text."})
    repository.commit("Merge", {_HOME: both}, parents=[main, side])
    repository.delete_branch("side")
    repository.commit("Grow", {_HOME: both.replace("known = 2;", "known = 2; bytes raw = 3;")})
    history = read_history(repository.write())
    assert _reused(history) == set()
    assert [usage.name for usage in history.numbers("Placement")[4]] == ["frame_id"]


def test_both_sides_add_a_message(repository: RepositoryBuilder) -> None:
    """A message that was picked to another branch is one message after the merge."""
    begin = repository.commit("Begin", {"README.md": "Text."})
    side = repository.commit("Add", {_HOME: POSE}, branch="side", parents=[begin])
    main = repository.commit("Pick", {_HOME: POSE})
    repository.commit("Merge", parents=[main, side])
    repository.delete_branch("side")
    assert [type.names for type in read_history(repository.write()).types] == [("Pose",)]


# --- changes that are not committed yet ---


@pytest.mark.slow
def test_the_working_tree_and_the_index_are_the_newest_states(
    repository: RepositoryBuilder, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A reuse is found when it is written, when it is staged, and in a file that git does not know yet.

    In a hook, only what is staged counts; `git commit FILE` gives the hook an index of its own.
    """
    root = repository.commits(*_LOST).write()
    assert _reused(read_history(root)) == set()
    index, next_index = root / ".git" / "index", root / ".git" / "next-index"
    next_index.write_bytes(index.read_bytes())
    (root / _HOME).write_text(REUSED)
    assert _reused(read_history(root)) == {("Pose", 3)}
    with monkeypatch.context() as hook:
        hook.setenv("GIT_INDEX_FILE", str(index))
        assert _reused(read_history(root)) == set()
        git(root, "add", _HOME)
        assert _reused(read_history(root)) == {("Pose", 3)}
        hook.setenv("GIT_INDEX_FILE", str(next_index))
        assert _reused(read_history(root)) == set()
    assert _reused(read_history(root)) == {("Pose", 3)}
    git(root, "rm", "--quiet", "--cached", _HOME)
    assert _reused(read_history(root)) == {("Pose", 3)}
    (usage,) = (usage for usage in read_history(root).numbers("Pose")[3] if usage.name == "label_text")
    assert str(usage.came) == "a change in the working tree that is not committed yet"
    assert usage.live_at == ("the working tree",)


def test_a_merge_that_is_not_committed_yet(repository: RepositoryBuilder) -> None:
    """Both sides are the past of the merge that is being made, even with conflicts."""
    begin = repository.commit("Begin", {_HOME: POSE})
    repository.branch("side", begin)
    repository.commit("Lose z", {_HOME: WITHOUT_Z}, branch="side")
    repository.commit("Change z", {_HOME: POSE.replace("float height", "double z")})
    root = repository.write()
    with pytest.raises(AssertionError):  # git says that there are conflicts
        git(root, "-c", "user.name=a", "-c", "user.email=a", "merge", "side")
    (root / _HOME).write_text(WITHOUT_Z)
    history = read_history(root)
    assert [usage.live_at for usage in history.numbers("Pose")[4]] == [("refs/heads/main", "refs/heads/side")]
    assert {
        usage.type: sorted(went.subject for one in usage.intervals for went in one.went)
        for usage in history.numbers("Pose")[3]
    } == {"float": ["Change z", "Lose z"], "double": ["a change in the working tree that is not committed yet"]}
