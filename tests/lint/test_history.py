"""All of a repository's history: every branch, both sides of every merge, whatever the files were called."""

from __future__ import annotations

from collections.abc import Mapping

import pytest
from repositories import ENVELOPE_FILE, PAYLOADS, RepositoryBuilder, envelope, git, members

from roverlink.generator.lint.history import History, Kind, Relation, Usage, read_history

_IMU = members("I1")[0]
_LETTERS = {"Imu": "I", "Gps": "G", "Ph": "P", "LoadCell": "L"}
_MAIN = ("refs/heads/main",)


def _read(repository: RepositoryBuilder, *states: Mapping[str, str | None]) -> History:
    """The history of a repository, after further commits 0, 1, ... on its branch main."""
    return read_history(repository.commits(*states).write())


def _life(usage: Usage) -> str:
    """A usage: the letter of its type, by which commits it came and went, and where it is if that is not only main."""
    doubt = "?" if usage.broken else ""
    intervals = [f"{one.came.subject}-{'+'.join(went.subject for went in one.went)}" for one in usage.intervals]
    live = "" if usage.live_at in ((), _MAIN) else " @" + " @".join(usage.live_at).replace("refs/heads/", "")
    return f"{_LETTERS.get(usage.type, usage.type)}{doubt} {' '.join(intervals)}{live}"


def _lives(history: History, name: str = "PBEnvelope") -> str:
    numbers = history.numbers(name).items()
    return " / ".join(f"{number}: " + " | ".join(map(_life, usages)) for number, usages in numbers)


_HISTORIES = {
    "deleted and reused later": ("a: I1 G2 / b: I1 / c: I1 / d: I1 L2", "1: I a- / 2: G a-b | L d-", [2]),
    "shifted by one": (
        "a: I1 G2 P3 / b: L1 I2 G3 P4",
        "1: I a-b | L b- / 2: G a-b | I b- / 3: P a-b | G b- / 4: P b-",
        [1, 2, 3],
    ),
    "a revert is one life": ("a: I1 G2 / b: I1 / c: I1 G2", "1: I a- / 2: G a-b c-", []),
    "reused on a merged side branch": (
        "a: I1 / b on a: I1 G2 / c on b: I1 / d on a: I1 / e on d c: I1 / f: I1 L2",
        "1: I a- / 2: G b-c | L f-",
        [2],
    ),
    "an octopus": (
        "a: I1 / b on a: I1 G2 / c on a: I1 P3 / d on a: I1 L4 / m on a b c d: I1 G2 P3 L4 / z: I1 G2 L4",
        "1: I a- / 2: G b- / 3: P c-z / 4: L d-",
        [],
    ),
    "a merge that adds a member and drops one": (
        "a: I1 / b on a: I1 G2 / c on a: I1 P3 / m on c b: I1 P3 L4",
        "1: I a- / 2: G b-m / 3: P c- / 4: L m-",
        [],
    ),
    "a merge that carries a deletion over": (
        "a: I1 G2 / b on a: I1 / c on a: I1 G2 P3 / m on c b: I1 P3",
        "1: I a- / 2: G a-b / 3: P c-",
        [],
    ),
    "the same on both sides": (
        "a: I1 / b on a: I1 G2 / c on a: I1 G2 / m on c b: I1 G2 / z: I1",
        "1: I a- / 2: G b-z c-z",
        [],
    ),
    "an old branch still has it": (
        "a: I1 G2 / old on a: I1 G2 P3 / c on a: I1 L2",
        "1: I a- @main @old / 2: G a-c @old | L c- / 3: P old- @old",
        [2],
    ),
}


@pytest.mark.parametrize("case", _HISTORIES)
def test_lives_of_numbers(repository: RepositoryBuilder, case: str) -> None:
    """Each payload of a number comes and goes where a commit says so, and a second one is a reuse."""
    played, lives, reused = _HISTORIES[case]
    repository.play(played)
    history = _read(repository)
    assert _lives(history) == lives
    found = [(reuse.number, reuse.kind, reuse.relation) for reuse in history.reuses("PBEnvelope")]
    assert found == [(number, Kind.REUSED, Relation.SUCCESSION) for number in reused]


# --- branches ---


def test_a_branch_collides_with_the_default_one(repository: RepositoryBuilder) -> None:
    """Open branches collide with each other and with main; a merged one, or main on a remote, does not."""
    played = "a: I1 / gps on a: I1 G2 / more on a: I1 G2 / ph on a: I1 P2 / merged on a: I1 L2 / m on a merged: I1 L2"
    marks = repository.play(played)
    repository.branch("merged", marks["merged"])
    repository.remote_branch("ph", marks["m"])
    repository.remote_branch("main", marks["m"])
    (collision,) = _read(repository).collisions("PBEnvelope")
    refs = {"Gps": ("refs/heads/gps", "refs/heads/more"), "LoadCell": _MAIN, "Ph": ("refs/heads/ph",)}
    assert {use.type: use.refs for use in collision.allocations} == refs


def test_a_tag_makes_the_reuse_of_a_branch_public(repository: RepositoryBuilder) -> None:
    """What only an unmerged branch has done may still be changed, unless it was released under a tag."""
    repository.play("a: I1 / b on a: I1 G2 / side on b: I1 L2 / z on a: I1")
    root = repository.write()
    assert [reuse.unmerged for reuse in read_history(root).reuses("PBEnvelope")] == [True]
    git(root, "tag", "v1", "side")
    assert [reuse.unmerged for reuse in read_history(root).reuses("PBEnvelope")] == [False]


# --- what a type stands for ---


def test_a_type_that_is_not_in_the_repository(repository: RepositoryBuilder) -> None:
    """Where a payload's file is missing, what its type stands for is not known."""
    load = {ENVELOPE_FILE: envelope(*members("L1")), **PAYLOADS}
    (reuse,) = _read(repository, {ENVELOPE_FILE: envelope("Elsewhere gps = 1;")}, load).reuses("PBEnvelope")
    assert (reuse.kind, reuse.old) == (Kind.REUSED, None)


# --- states that do not compile ---

_CONFLICT = "<<<<<<< HEAD\n    Gps gps = 2;\n=======\n    LoadCell load_cell = 2;\n>>>>>>> side"


@pytest.mark.parametrize(
    ("states", "lives", "relations"),
    [
        (
            [["Imu imu 1", "Gps gps = 2;"], ["Imu imu 1", "LoadCell load_cell = 2;"]],
            "1: I? 0- / 2: G? 0-1 | L? 1-",
            ["SUCCESSION"],
        ),
        ([[_IMU], ["Imu imu = 1", "}", "Gps gps = 2;"], [_IMU, "Gps gps = 2;"]], "1: I 0- / 2: G 1-", []),
        ([[_IMU], [_IMU, _CONFLICT], [_IMU, "Gps gps = 2;"]], "1: I 0- / 2: G 1- | L? 1-2", ["TOGETHER"]),
    ],
    ids=["a file that never compiled", "a state that does not compile", "conflict markers committed"],
)
def test_states_that_do_not_compile(
    repository: RepositoryBuilder, states: list[list[str]], lives: str, relations: list[str]
) -> None:
    """A line that nobody can read hides no other; what no sound state says is said with doubt."""
    history = _read(repository, *({ENVELOPE_FILE: envelope(*state)} for state in states))
    assert _lives(history) == lives
    assert [reuse.relation.name for reuse in history.reuses("PBEnvelope")] == relations


def test_commented_out_members(repository: RepositoryBuilder) -> None:
    """A member in a comment is a claim with a life of its own; it is no use of its number."""
    before = envelope(_IMU, "// Gps gps = 2;", "// see Ph ph = 3; for more")
    history = _read(repository, {ENVELOPE_FILE: before}, {ENVELOPE_FILE: envelope(*members("I1 L2"))})
    assert [(number, *map(_life, claims)) for number, claims in history.claims("PBEnvelope").items()] == [(2, "G 0-1")]
    assert history.claims("PBEnvelope")[2][0].oneof == "payload"
    assert _lives(history) == "1: I 0- / 2: L 1-"


def test_a_file_that_cannot_be_looked_at(repository: RepositoryBuilder) -> None:
    """A binary file is named, and all others are read."""
    files = {"binary.proto": "\0\1", ENVELOPE_FILE: envelope(_IMU), "odd.proto": "// \udcff\nmessage Odd {}"}
    history = _read(repository, files)
    assert history.unread == ("binary.proto",)
    assert list(history.numbers("PBEnvelope")) == [1]


# --- repositories ---


def test_a_history_of_nothing(repository: RepositoryBuilder) -> None:
    """Without commits, or with commits about something else, nothing is wrong and nothing is said."""
    history = _read(repository)
    assert (history.commits, history.depth, history.shallow, history.messages) == (0, 0, False, ())
    assert history.numbers("PBEnvelope") == {}
    assert (history.reuses("PBEnvelope"), history.collisions("PBEnvelope")) == ((), ())
    history = _read(repository, {"README.md": "Nothing."})
    assert (history.commits, history.depth, history.messages) == (1, 1, ())


def test_the_user_s_settings(repository: RepositoryBuilder) -> None:
    """What somebody has set for what git shows them changes nothing."""
    repository.play("a: I1 G2")
    repository.commit("Rename", {ENVELOPE_FILE: None, "ä b.proto": envelope(*members("I1 G2"))})
    root = repository.write()
    before = read_history(root).numbers("PBEnvelope")
    settings = "log.showRoot=false diff.renames=copies log.follow=true color.ui=always core.abbrev=5"
    for setting in f"{settings} log.diffMerges=off diff.relative=true".split():
        git(root, "config", *setting.split("="))
    assert read_history(root).numbers("PBEnvelope") == before
    assert before[1][0].path == ENVELOPE_FILE


def test_a_stash_and_a_detached_head(repository: RepositoryBuilder) -> None:
    """What somebody put aside is nobody's history; what is checked out is, on a branch or not."""
    repository.play("a: I1")
    root = repository.write()
    identity = ("-c", "user.name=a", "-c", "user.email=a")
    (root / ENVELOPE_FILE).write_text(envelope(*members("I1 G2")))
    git(root, *identity, "stash", "--quiet")
    (root / ENVELOPE_FILE).write_text(envelope(*members("I1 P3")))
    git(root, "checkout", "--quiet", "--detach")
    git(root, *identity, "commit", "--quiet", "--all", "--message", "Work")
    assert _lives(read_history(root)) == "1: I a- @HEAD @main / 3: P Work- @HEAD"


def test_progress_is_told(repository: RepositoryBuilder) -> None:
    """Who waits is told how many states of files are read, up to the last one."""
    for number in range(1, 150):
        repository.commit(f"Commit {number}", {ENVELOPE_FILE: envelope(f"Imu imu = {number};")})
    told: list[tuple[int, int]] = []
    read_history(repository.write(), lambda done, total: told.append((done, total)))
    assert told == [(0, 149), (64, 149), (128, 149), (149, 149)]
