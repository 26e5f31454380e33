"""All of a repository's history: every branch, both sides of every merge, whatever the files were called."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path
from random import Random

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from repositories import RepositoryBuilder, envelope, git, message

from roverlink.generator.git import GitError
from roverlink.generator.lint.history import History, Kind, Relation, Reuse, Usage, read_history
from roverlink.generator.lint.history.branch_collisions import default_branch
from roverlink.generator.lint.history.commits import PastRepository

_EXAMPLES = settings(suppress_health_check=list(HealthCheck), derandomize=True)
_FILE = "components/common/envelope.proto"

IMU, GPS, PH, LOAD = "Imu imu = 1;", "Gps gps = 2;", "Ph ph = 3;", "LoadCell load_cell = 4;"
PAYLOADS = {
    "imu.proto": message("Imu", "float accel_x", "float accel_y", "float accel_z"),
    "gps.proto": message("Gps", "double latitude", "double longitude", "uint32 satellites"),
    "ph.proto": message("Ph", "float acidity", "bool calibrated"),
    "load.proto": message("LoadCell", "int32 ticks", "string unit_name", "bytes raw"),
}


@pytest.fixture
def repository(tmp_path: Path) -> RepositoryBuilder:
    """A repository without commits."""
    return RepositoryBuilder(tmp_path / "repository")


def _payloads(repository: RepositoryBuilder, *members: str) -> int:
    return repository.commit("Begin", {_FILE: envelope(*members), **PAYLOADS})


def _read(repository: RepositoryBuilder) -> History:
    return read_history(repository.write())


def _shown(usage: Usage) -> tuple[str, str, list[tuple[str, list[str]]]]:
    """A life's type and name, and the subjects of the commits by which it came and went."""
    return usage.type, usage.name, [(one.came.subject, [went.subject for went in one.went]) for one in usage.intervals]


def _usages(
    history: History, number: int, name: str = "PBEnvelope"
) -> list[tuple[str, str, list[tuple[str, list[str]]]]]:
    return [_shown(usage) for usage in history.numbers(name)[number]]


def _only(reuses: tuple[Reuse, ...]) -> Reuse:
    assert len(reuses) == 1, reuses
    return reuses[0]


# --- one line of history ----------------------------------------------------------------------------------------


def test_deleted_and_reused_later(repository: RepositoryBuilder) -> None:
    """A number that was free for a while has two lives, and both are named with their commits."""
    _payloads(repository, IMU, GPS)
    repository.commit("Take GPS away", {_FILE: envelope(IMU)})
    repository.commit("Write about it", {"README.md": "Nothing."})
    repository.commit("Weigh", {_FILE: envelope(IMU, "LoadCell load_cell = 2;")})
    history = _read(repository)
    assert _usages(history, 2) == [
        ("Gps", "gps", [("Begin", ["Take GPS away"])]),
        ("LoadCell", "load_cell", [("Weigh", [])]),
    ]
    reuse = _only(history.reuses("PBEnvelope"))
    assert (reuse.number, reuse.kind, reuse.relation) == (2, Kind.REUSED, Relation.SUCCESSION)
    assert (reuse.survivors, reuse.earlier.broken, reuse.later.broken) == (0, False, False)
    assert reuse.certain
    assert (reuse.earlier.path, reuse.earlier.line) == (_FILE, 6)
    assert reuse.earlier.went is not None
    assert (reuse.earlier.went.subject, reuse.later.went) == ("Take GPS away", None)
    assert (reuse.earlier.live_at, reuse.later.live_at) == ((), ("refs/heads/main",))
    assert reuse.later.came.date == "2026-02-06"
    assert reuse.old is not None
    assert [fact.name for fact in reuse.old.facts] == ["latitude", "longitude", "satellites"]
    assert reuse.new is not None
    assert (reuse.new.type, reuse.new.path, reuse.new.line) == ("LoadCell", "load.proto", 3)


def test_shifted_by_one(repository: RepositoryBuilder) -> None:
    """A member put in between gives every number behind it to another payload."""
    _payloads(repository, IMU, GPS, PH)
    shifted = envelope("LoadCell load_cell = 1;", "Imu imu = 2;", "Gps gps = 3;", "Ph ph = 4;")
    repository.commit("Weigh first", {_FILE: shifted})
    history = _read(repository)
    assert [(reuse.number, reuse.kind) for reuse in history.reuses("PBEnvelope")] == [
        (number, Kind.REUSED) for number in (1, 2, 3)
    ]
    assert list(history.numbers("PBEnvelope")) == [1, 2, 3, 4]


def test_likes_that_change_places_are_no_renames(repository: RepositoryBuilder) -> None:
    """Two messages of the same fields that both go on are two; where one takes the other's number, that is a reuse."""
    twins = {f"{name}.proto": message(name, "float base", "float elbow", "float grip") for name in ("Target", "Actual")}
    before = envelope("Target arm_target = 1;", "Actual arm_actual = 2;")
    repository.commit("Move", {_FILE: before, **twins})
    repository.commit("Swap", {_FILE: envelope("Actual arm_actual = 1;", "Target arm_target = 2;")})
    assert [reuse.kind for reuse in _read(repository).reuses("PBEnvelope")] == [Kind.REUSED] * 2


def test_a_revert_is_one_life(repository: RepositoryBuilder) -> None:
    """What was taken away and put back as it was has lived twice, and is no reuse."""
    _payloads(repository, IMU, GPS)
    repository.commit("Take GPS away", {_FILE: envelope(IMU)})
    repository.commit("Put it back", {_FILE: envelope(IMU, GPS)})
    history = _read(repository)
    assert _usages(history, 2) == [("Gps", "gps", [("Begin", ["Take GPS away"]), ("Put it back", [])])]
    assert history.numbers("PBEnvelope")[2][0].went is None
    assert history.reuses("PBEnvelope") == ()


def test_a_renamed_file(repository: RepositoryBuilder) -> None:
    """The envelope is one, whatever its file is called; a life begins where it began, in the file of that time."""
    _payloads(repository, IMU, GPS)
    repository.commit("Rename", {_FILE: None, "link.proto": envelope(IMU, GPS)})
    repository.commit("Weigh", {"link.proto": envelope(IMU, "LoadCell load_cell = 2;")})
    history = _read(repository)
    assert _usages(history, 1) == [("Imu", "imu", [("Begin", [])])]
    reuse = _only(history.reuses("PBEnvelope"))
    assert (reuse.earlier.path, reuse.later.path) == (_FILE, "link.proto")


def test_a_moved_folder(repository: RepositoryBuilder) -> None:
    """A tree that moves takes its history with it, messages and enums too."""
    begin = {_FILE: envelope(IMU, GPS), **PAYLOADS}
    repository.commit("Begin", begin)
    moved = {f"lib/protos/{path}": text for path, text in begin.items()}
    repository.commit("Move", {**dict.fromkeys(begin), **moved})
    repository.commit("Weigh", {f"lib/protos/{_FILE}": envelope(IMU, "LoadCell load_cell = 2;")})
    history = _read(repository)
    assert [reuse.number for reuse in history.reuses("PBEnvelope")] == [2]
    assert [usages[0].came.subject for usages in history.numbers("Imu").values()] == ["Begin"] * 3
    assert {usage.went for usages in history.numbers("Imu").values() for usage in usages} == {None}


def test_a_new_package(repository: RepositoryBuilder) -> None:
    """A message that gets a package is the same message, asked for with the package or without."""
    _payloads(repository, IMU, GPS)
    renamed = envelope(IMU, "LoadCell load_cell = 2;").replace("\nmessage", "package rover;\n\nmessage")
    repository.commit("Give it a package", {_FILE: renamed})
    history = _read(repository)
    for name in ("PBEnvelope", "rover.PBEnvelope"):
        assert [reuse.kind for reuse in history.reuses(name)] == [Kind.REUSED]
        assert _usages(history, 1, name) == [("Imu", "imu", [("Begin", [])])]


def test_two_messages_of_one_name(repository: RepositoryBuilder) -> None:
    """Messages of two packages that stand beside each other are two, and their numbers do not collide."""
    files = {
        f"{name}.proto": f"package {name};\nmessage Status {{ {type} x = 1; }}"
        for name, type in (("arm", "int32"), ("drive", "string"))
    }
    repository.commit("Begin", files)
    history = _read(repository)
    assert history.messages == ("arm.Status", "drive.Status")
    assert history.reuses("arm.Status") == history.reuses("drive.Status") == ()


# --- branches and merges ----------------------------------------------------------------------------------------


def test_reused_on_a_merged_side_branch(repository: RepositoryBuilder) -> None:
    """What was given away and given up again within a side branch is found, though no first parent ever had it."""
    begin = _payloads(repository, IMU)
    repository.branch("side", begin)
    repository.commit("Try GPS", {_FILE: envelope(IMU, GPS)}, branch="side")
    side = repository.commit("Give up GPS", {_FILE: envelope(IMU)}, branch="side")
    main = repository.commit("Write", {"README.md": "Nothing."})
    repository.commit("Merge", parents=[main, side])
    repository.delete_branch("side")
    repository.commit("Weigh", {_FILE: envelope(IMU, "LoadCell load_cell = 2;")})
    history = _read(repository)
    reuse = _only(history.reuses("PBEnvelope"))
    assert (reuse.earlier.came.subject, reuse.relation) == ("Try GPS", Relation.SUCCESSION)
    assert _usages(history, 2)[0] == ("Gps", "gps", [("Try GPS", ["Give up GPS"])])


def test_two_branches_one_number(repository: RepositoryBuilder) -> None:
    """Branches that are open and gave a number to different payloads collide, with the commits in which they did."""
    begin = _payloads(repository, IMU)
    for name, member in (("gps", GPS), ("weigh", "LoadCell load_cell = 2;"), ("same", GPS), ("ph", PH)):
        repository.branch(name, begin)
        repository.commit(f"Add {name}", {_FILE: envelope(IMU, member)}, branch=name)
    history = _read(repository)
    collisions = history.collisions("PBEnvelope")
    assert [
        (one.number, [(use.refs, use.type, use.came.subject) for use in one.allocations]) for one in collisions
    ] == [
        (
            2,
            [
                (("refs/heads/gps", "refs/heads/same"), "Gps", "Add gps"),
                (("refs/heads/weigh",), "LoadCell", "Add weigh"),
            ],
        )
    ]
    reuse = _only(history.reuses("PBEnvelope"))
    assert reuse.relation is Relation.BRANCHES
    assert reuse.earlier.live_at == ("refs/heads/gps", "refs/heads/same")


def test_a_branch_collides_with_the_default_one(repository: RepositoryBuilder) -> None:
    """So does a branch with what it will be merged into; what is merged, or is that branch on a remote, does not."""
    begin = _payloads(repository, IMU)
    repository.branch("gps", begin)
    repository.commit("Locate", {_FILE: envelope(IMU, GPS)}, branch="gps")
    repository.branch("merged", begin)
    repository.commit("Weigh", {_FILE: envelope(IMU, "LoadCell load_cell = 2;")}, branch="merged")
    main = repository.commit("Merge", {_FILE: envelope(IMU, "LoadCell load_cell = 2;")}, parents=[begin, 3])
    repository.commit("Weigh again", {_FILE: envelope(IMU, "Scale scale = 2;")}, branch="again", parents=[begin])
    repository.remote_branch("again", main)
    repository.remote_branch("main", main)
    history = _read(repository)
    assert [{use.type: use.refs for use in one.allocations} for one in history.collisions("PBEnvelope")] == [
        {
            "Gps": ("refs/heads/gps",),
            "LoadCell": ("refs/heads/main",),
            "Scale": ("refs/heads/again",),
        }
    ]


def test_the_default_branch_is_the_remote_s(repository: RepositoryBuilder) -> None:
    """Where a remote says which branch is its default one, that is believed."""
    _payloads(repository, IMU)
    repository.remote_branch("trunk")
    root = repository.write()
    git(root, "symbolic-ref", "refs/remotes/origin/HEAD", "refs/remotes/origin/trunk")
    assert default_branch(PastRepository(root).refs()) == "refs/remotes/origin/trunk"


def test_an_octopus(repository: RepositoryBuilder) -> None:
    """What three branches bring into one merge came where they made it, and goes once."""
    begin = _payloads(repository, IMU)
    tips = []
    for name, member in (("gps", GPS), ("ph", PH), ("load", LOAD)):
        tips.append(repository.commit(f"Add {name}", {_FILE: envelope(IMU, member)}, branch=name, parents=[begin]))
        repository.delete_branch(name)
    merged = envelope(IMU, GPS, PH, LOAD)
    repository.commit("Merge all", {_FILE: merged}, parents=[begin, *tips])
    repository.commit("Take PH away", {_FILE: envelope(IMU, GPS, LOAD)})
    history = _read(repository)
    assert [_usages(history, number)[0][2] for number in (1, 2, 3, 4)] == [
        [("Begin", [])],
        [("Add gps", [])],
        [("Add ph", ["Take PH away"])],
        [("Add load", [])],
    ]
    assert history.reuses("PBEnvelope") == ()


def test_a_merge_that_changes_something_itself(repository: RepositoryBuilder) -> None:
    """What no parent had comes with the merge; what the merge drops, though nobody had taken it away, goes with it."""
    begin = _payloads(repository, IMU)
    side = repository.commit("Add GPS", {_FILE: envelope(IMU, GPS)}, branch="side", parents=[begin])
    repository.delete_branch("side")
    main = repository.commit("Add PH", {_FILE: envelope(IMU, PH)})
    repository.commit("Merge badly", {_FILE: envelope(IMU, PH, LOAD)}, parents=[main, side])
    history = _read(repository)
    assert _usages(history, 2) == [("Gps", "gps", [("Add GPS", ["Merge badly"])])]
    assert _usages(history, 3) == [("Ph", "ph", [("Add PH", [])])]
    assert _usages(history, 4) == [("LoadCell", "load_cell", [("Merge badly", [])])]


def test_a_merge_that_carries_a_deletion_over(repository: RepositoryBuilder) -> None:
    """Where one side took something away and the other still had it, it went with the commit of the one side."""
    begin = _payloads(repository, IMU, GPS)
    side = repository.commit("Take GPS away", {_FILE: envelope(IMU)}, branch="side", parents=[begin])
    repository.delete_branch("side")
    main = repository.commit("Add PH", {_FILE: envelope(IMU, GPS, PH)})
    repository.commit("Merge", {_FILE: envelope(IMU, PH)}, parents=[main, side])
    history = _read(repository)
    assert _usages(history, 2) == [("Gps", "gps", [("Begin", ["Take GPS away"])])]
    assert history.numbers("PBEnvelope")[2][0].went is not None


def test_the_same_on_both_sides(repository: RepositoryBuilder) -> None:
    """What was picked to two branches came twice, is one life, and goes as one after they were merged."""
    begin = _payloads(repository, IMU)
    side = repository.commit("Add GPS", {_FILE: envelope(IMU, GPS)}, branch="side", parents=[begin])
    repository.delete_branch("side")
    main = repository.commit("Pick GPS", {_FILE: envelope(IMU, GPS)}, parents=[begin])
    repository.commit("Merge", parents=[main, side])
    repository.commit("Take GPS away", {_FILE: envelope(IMU)})
    history = _read(repository)
    went = ["Take GPS away"]
    assert _usages(history, 2) == [("Gps", "gps", [("Add GPS", went), ("Pick GPS", went)])]


def test_an_old_branch_still_has_it(repository: RepositoryBuilder) -> None:
    """A number that was given away while a branch goes on with the old use was in use for both at once."""
    begin = _payloads(repository, IMU, GPS)
    repository.branch("old", begin)
    repository.commit("Weigh", {_FILE: envelope(IMU, "LoadCell load_cell = 2;")})
    reuse = _only(_read(repository).reuses("PBEnvelope"))
    assert reuse.relation is Relation.SUCCESSION
    assert (reuse.earlier.live_at, reuse.earlier.went) == (("refs/heads/old",), None)


# --- what a type stands for -------------------------------------------------------------------------------------


def test_a_mere_rename(repository: RepositoryBuilder) -> None:
    """A payload that has a new name and its old fields is said to be renamed; both contents are there to be shown."""
    _payloads(repository, IMU, GPS)
    position = message("Position", "double latitude", "double longitude", "uint32 satellites", "float altitude")
    files = {_FILE: envelope(IMU, "Position where = 2;"), "gps.proto": None, "position.proto": position}
    repository.commit("Call it by its name", files)
    reuse = _only(_read(repository).reuses("PBEnvelope"))
    assert (reuse.kind, reuse.certain, reuse.survivors) == (Kind.RENAMED, False, 3)
    assert reuse.old is not None
    assert reuse.new is not None
    assert (reuse.old.type, len(reuse.old.facts), reuse.new.type, len(reuse.new.facts)) == ("Gps", 3, "Position", 4)


def test_a_rename_in_two_commits(repository: RepositoryBuilder) -> None:
    """Where the payload was renamed in a commit and the envelope in the next, what compiled before is compared."""
    _payloads(repository, IMU, GPS)
    repository.commit("Rename", {"gps.proto": PAYLOADS["gps.proto"].replace("Gps", "Position")})
    repository.commit("Mend", {_FILE: envelope(IMU, "Position where = 2;")})
    reuse = _only(_read(repository).reuses("PBEnvelope"))
    assert reuse.kind is Kind.RENAMED
    assert reuse.old is not None
    assert (reuse.old.commit.subject, reuse.old.there) == ("Begin", False)


def test_renames_in_steps(repository: RepositoryBuilder) -> None:
    """A payload that is renamed and grows by turns stays itself, however little the last has of the first."""
    names = ["heading", "speed", "battery", "voltage", "climb", "drift", "time_ms"]
    for step, type in enumerate(("Pose", "Track", "Course")):
        fields = [f"float {name} = {names.index(name) + 1};" for name in names[step : step + 4]]
        member = f"{type} {type.lower()} = 1;"
        repository.commit(f"Step {step}", {_FILE: envelope(member), "pose.proto": message(type, *fields)})
    assert {reuse.kind for reuse in _read(repository).reuses("PBEnvelope")} == {Kind.RENAMED}


def test_content_replaced_under_the_same_name(repository: RepositoryBuilder) -> None:
    """A payload that keeps its name and has other fields is another one, though the envelope never changed."""
    _payloads(repository, IMU, GPS)
    repository.commit("Empty", {"gps.proto": message("Gps")})
    repository.commit("Fill", {"gps.proto": message("Gps", "string text", "bool busy", "bytes map_tile")})
    reuse = _only(_read(repository).reuses("PBEnvelope"))
    assert (reuse.number, reuse.kind, reuse.survivors) == (2, Kind.REPLACED, 0)
    assert reuse.earlier is reuse.later
    assert reuse.old is not None
    assert reuse.new is not None
    assert (reuse.old.commit.subject, reuse.new.commit.subject) == ("Begin", "Fill")


def test_a_message_that_grows_is_not_replaced(repository: RepositoryBuilder) -> None:
    """Fields that are added, deleted, or called by a better name leave a message what it is."""
    _payloads(repository, IMU, GPS)
    repository.commit("Grow", {"gps.proto": message("Gps", "double lat", "double longitude_deg", "bool fix = 4;")})
    assert _read(repository).reuses("PBEnvelope") == ()


def test_a_type_that_is_not_in_the_repository(repository: RepositoryBuilder) -> None:
    """Where a payload's file is missing, what its type stands for is not known."""
    repository.commit("Begin", {_FILE: envelope("Elsewhere gps = 1;")})
    repository.commit("Weigh", {_FILE: envelope("LoadCell load_cell = 1;"), **PAYLOADS})
    reuse = _only(_read(repository).reuses("PBEnvelope"))
    assert (reuse.kind, reuse.old) == (Kind.REUSED, None)


def _field_kinds(repository: RepositoryBuilder, before: str, after: str) -> list[Kind]:
    types = "enum Mode { OFF = 0; }\nmessage Part { int32 a = 1; }\nmessage Other { string b = 1; }\n"
    repository.commit("Before", {"a.proto": f"message A {{ {before} }}\n{types}"})
    repository.commit("After", {"a.proto": f"message A {{ {after} }}\n{types}"})
    return [reuse.kind for reuse in _read(repository).reuses("A")]


@pytest.mark.parametrize(
    ("before", "after", "kinds"),
    [
        ("int32 speed = 1;", "int64 speed = 1;", []),
        ("int32 speed = 1;", "optional int32 speed = 1;", []),
        ("int32 speed = 1;", "float speed = 1;", [Kind.RETYPED]),
        ("int32 speed = 1;", "int32 motor_speed = 1;", [Kind.RENAMED]),
        ("int32 speed = 1;", "int32 voltage = 1;", [Kind.MEANING]),
        ("int32 mode = 1;", "Mode mode = 1;", []),
        ("int32 part = 1;", "Part part = 1;", [Kind.RETYPED]),
        ("Part part = 1;", "Other part = 1;", [Kind.REUSED]),
        ("Mode part = 1;", "Part part = 1;", [Kind.RETYPED]),
        ("Part accel = 1;", "Part gyro = 1;", [Kind.MEANING]),
        ("map<int32, Part> parts = 1;", "Part parts = 1;", [Kind.RETYPED]),
    ],
)
def test_fields_of_payloads(repository: RepositoryBuilder, before: str, after: str, kinds: list[Kind]) -> None:
    """Of a payload's field, the type has to read the old bytes, and the name has to be similar."""
    assert _field_kinds(repository, before, after) == kinds


def test_extensions(repository: RepositoryBuilder) -> None:
    """A number of an extension is one of the message, wherever that is declared."""
    base = 'syntax = "proto2";\npackage p;\nmessage Base { extensions 100 to 199; }\n'
    extend = 'syntax = "proto2";\npackage p;\nimport "base.proto";\nextend Base { optional float speed = 100; }\n'
    repository.commit("Before", {"base.proto": base, "more.proto": extend})
    repository.commit("After", {"more.proto": extend.replace("speed", "current")})
    reuse = _only(_read(repository).reuses("p.Base"))
    assert (reuse.number, reuse.earlier.name, reuse.later.name, reuse.kind) == (100, "speed", "current", Kind.MEANING)


def test_values_of_enums(repository: RepositoryBuilder) -> None:
    """The words that all values of an enum have do not make two of them alike."""
    before = "enum ImuError { IMU_NONE = 0; IMU_TIMEOUT = 1; IMU_GYRO = 2; IMU_MAG = 3; IMU_X = 4; IMU_ALIAS = 4; }"
    after = before.replace("IMU_TIMEOUT", "IMU_OVERHEATED").replace("IMU_GYRO", "IMU_GYRO_FAULT")
    repository.commit("Before", {"a.proto": before})
    repository.commit("After", {"a.proto": after})
    history = _read(repository)
    assert history.enums == ("ImuError",)
    assert [(r.earlier.name, r.later.name, r.kind) for r in history.reuses("ImuError")] == [
        ("IMU_TIMEOUT", "IMU_OVERHEATED", Kind.MEANING),
        ("IMU_GYRO", "IMU_GYRO_FAULT", Kind.RENAMED),
    ]


# --- states that do not compile ---------------------------------------------------------------------------------


def test_a_file_that_never_compiled(repository: RepositoryBuilder) -> None:
    """A line that nobody can read hides no other, in no state; what stands beside it is said with doubt."""
    repository.commit("Begin", {_FILE: envelope("Imu imu 1", GPS)})
    repository.commit("Weigh", {_FILE: envelope("Imu imu 1", "LoadCell load_cell = 2;")})
    reuse = _only(_read(repository).reuses("PBEnvelope"))
    assert (reuse.number, reuse.kind) == (2, Kind.REUSED)
    assert reuse.earlier.broken
    assert reuse.later.broken


def test_a_state_that_does_not_compile(repository: RepositoryBuilder) -> None:
    """What sound states say too is not in doubt because a broken one says it."""
    _payloads(repository, IMU, GPS)
    repository.commit("Break", {_FILE: envelope("Imu imu = 1", "}", GPS)})
    repository.commit("Mend", {_FILE: envelope(IMU, GPS)})
    usage = _read(repository).numbers("PBEnvelope")[1][0]
    assert (usage.broken, len(usage.intervals)) == (False, 1)


def test_conflict_markers_committed(repository: RepositoryBuilder) -> None:
    """Of a conflict that was committed, both sides are read: they stood in one state."""
    _payloads(repository, IMU)
    sides = f"<<<<<<< HEAD\n    {GPS}\n=======\n    LoadCell load_cell = 2;\n>>>>>>> side"
    conflict = envelope(IMU, GPS).replace(f"    {GPS}", sides)
    repository.commit("Merge without looking", {_FILE: conflict})
    repository.commit("Mend", {_FILE: envelope(IMU, GPS)})
    reuse = _only(_read(repository).reuses("PBEnvelope"))
    assert (reuse.number, reuse.relation) == (2, Relation.TOGETHER)
    assert {one.name: one.broken for one in (reuse.earlier, reuse.later)} == {"gps": False, "load_cell": True}


def test_commented_out_members(repository: RepositoryBuilder) -> None:
    """A member in a comment is a claim with a life of its own; it is no use of its number."""
    _payloads(repository, IMU, "// Gps gps = 2;", "// see Ph ph = 3; for more")
    repository.commit("Use it", {_FILE: envelope(IMU, "LoadCell load_cell = 2;")})
    history = _read(repository)
    assert [_shown(usage) for usage in history.claims("PBEnvelope")[2]] == [("Gps", "gps", [("Begin", ["Use it"])])]
    assert history.claims("PBEnvelope")[2][0].oneof == "payload"
    assert list(history.claims("PBEnvelope")) == [2]
    assert [usage.name for usage in history.numbers("PBEnvelope")[2]] == ["load_cell"]


def test_a_file_that_cannot_be_looked_at(repository: RepositoryBuilder) -> None:
    """A binary file is named, and all others are read."""
    repository.commit("Begin", {"binary.proto": "\0\1", _FILE: envelope(IMU), "odd.proto": "// \udcff\nmessage Odd {}"})
    history = _read(repository)
    assert history.unread == ("binary.proto",)
    assert list(history.numbers("PBEnvelope")) == [1]


# --- repositories -----------------------------------------------------------------------------------------------


def test_an_empty_repository(repository: RepositoryBuilder) -> None:
    """Without commits, there is no history, and nothing is wrong with that."""
    history = _read(repository)
    assert (history.commits, history.depth, history.shallow, history.messages) == (0, 0, False, ())
    assert history.numbers("PBEnvelope") == {}
    assert (history.reuses("PBEnvelope"), history.collisions("PBEnvelope")) == ((), ())


def test_a_repository_without_protos(repository: RepositoryBuilder) -> None:
    """Commits that are about something else are counted, and say nothing."""
    repository.commit("Begin", {"README.md": "Nothing."})
    history = _read(repository)
    assert (history.commits, history.depth, history.messages) == (1, 1, ())


def test_no_repository(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Outside of a repository, git's own words say so."""
    monkeypatch.setenv("GIT_CEILING_DIRECTORIES", str(tmp_path.parent))
    with pytest.raises(GitError, match="not a git repository"):
        read_history(tmp_path)


def test_a_shallow_clone(repository: RepositoryBuilder, tmp_path: Path) -> None:
    """A clone that was cut off says so, and how deep it is; what was there at its end may be older."""
    _payloads(repository, IMU, GPS)
    repository.commit("Take GPS away", {_FILE: envelope(IMU)})
    repository.commit("Weigh", {_FILE: envelope(IMU, "LoadCell load_cell = 2;")})
    origin = repository.write()
    git(tmp_path, "clone", "--quiet", "--depth", "2", f"file://{origin}", "clone")
    history, full = read_history(tmp_path / "clone"), read_history(origin)
    assert (history.shallow, history.depth, history.commits) == (True, 2, 2)
    assert (full.shallow, full.depth) == (False, 3)
    usages = history.numbers("PBEnvelope")
    assert usages[1][0].came.subject == "Take GPS away"
    assert history.reuses("PBEnvelope") == ()


def test_a_folder_of_a_repository(repository: RepositoryBuilder) -> None:
    """Of a repository, only what is below the folder is read, and called from there."""
    files = {f"protos/{_FILE}": envelope(IMU), "other/envelope.proto": envelope(GPS)}
    repository.commit("Begin", files)
    root = repository.write()
    git(root, "reset", "--quiet", "--hard")
    history = read_history(root / "protos")
    assert [(usage.name, usage.path) for usages in history.numbers("PBEnvelope").values() for usage in usages] == [
        ("imu", _FILE)
    ]


def test_the_user_s_settings(repository: RepositoryBuilder) -> None:
    """What somebody has set for what git shows them changes nothing."""
    _payloads(repository, IMU, GPS)
    repository.commit("Rename", {_FILE: None, "ä b.proto": envelope(IMU, GPS)})
    root = repository.write()
    before = read_history(root)
    for setting in ("log.showRoot=false", "diff.renames=copies", "log.follow=true", "color.ui=always", "core.abbrev=5"):
        git(root, "config", *setting.split("="))
    git(root, "config", "log.diffMerges", "off")
    git(root, "config", "diff.relative", "true")
    after = read_history(root)
    assert after.numbers("PBEnvelope") == before.numbers("PBEnvelope")
    assert after.numbers("PBEnvelope")[1][0].path == _FILE


def test_a_stash_and_a_detached_head(repository: RepositoryBuilder) -> None:
    """What somebody put aside is nobody's history; what is checked out is, on a branch or not."""
    _payloads(repository, IMU)
    root = repository.write()
    git(root, "reset", "--quiet", "--hard")
    identity = ("-c", "user.name=a", "-c", "user.email=a")
    (root / _FILE).write_text(envelope(IMU, GPS))
    git(root, *identity, "stash", "--quiet")
    (root / _FILE).write_text(envelope(IMU, PH))
    git(root, "checkout", "--quiet", "--detach")
    git(root, *identity, "commit", "--quiet", "--all", "--message", "Work")
    history = read_history(root)
    assert list(history.numbers("PBEnvelope")) == [1, 3]
    assert history.numbers("PBEnvelope")[3][0].live_at == ("HEAD",)


def test_progress_is_told(repository: RepositoryBuilder) -> None:
    """Who waits is told how many states of files are read, up to the last one."""
    for number in range(1, 150):
        repository.commit(f"Commit {number}", {_FILE: envelope(f"Imu imu = {number};")})
    told: list[tuple[int, int]] = []
    read_history(repository.write(), lambda done, total: told.append((done, total)))
    assert told == [(0, 149), (64, 149), (128, 149), (149, 149)]


@pytest.mark.slow
def test_a_long_history(repository: RepositoryBuilder) -> None:
    """Two thousand commits of which each gives a number of the envelope away are read and compared."""
    members = [f"Message{number} member_{number} = {number};" for number in range(1, 61)]
    for step in range(2000):
        members[step % 60] = f"Message{step % 7} step_{step} = {step % 60 + 1};"
        repository.commit(f"Step {step}", {_FILE: envelope(*members)})
    root = repository.write()
    assert len(read_history(root).reuses("PBEnvelope")) > 2000


# --- made up at random ------------------------------------------------------------------------------------------


def _random_history(random: Random, root: Path, change: Callable[[Random, set[str]], None]) -> dict[int, set[str]]:
    """A repository of random commits and merges; the members of the envelope at each, by mark.

    Each commit's context is its mark. Each commit changes the members of its parents together, and stays a branch's tip
    if nothing is built upon it.
    """
    repository, members = RepositoryBuilder(root), dict[int, set[str]]()
    for mark in range(1, random.randint(3, 14)):
        known = random.sample(sorted(members), k=min(len(members), random.choice([1, 1, 1, 2, 2, 3])))
        members[mark] = set().union(*(members[parent] for parent in known))
        change(random, members[mark])
        text = envelope(*sorted(members[mark]))
        repository.commit(str(mark), {_FILE: text, **PAYLOADS}, branch=f"b{mark}", parents=known)
    repository.write()
    return members


def _add_or_take(random: Random, members: set[str]) -> None:
    """Members come and go; each number has one meaning for ever."""
    for number in range(1, 6):
        if random.random() < 0.3:
            members ^= {f"Message{number} member_{number} = {number};"}


@pytest.mark.slow
@settings(_EXAMPLES, max_examples=20)
@given(st.randoms(use_true_random=False))
def test_histories_without_reuse_give_nothing(random: Random) -> None:
    """However branches and merges bring members and take them away: if each keeps its number, nothing is found."""
    random = Random(random.getrandbits(64))  # noqa: S311  # one draw a history
    with tempfile.TemporaryDirectory() as folder:
        members = _random_history(random, Path(folder), _add_or_take)
        history = read_history(Path(folder))
    assert (history.reuses("PBEnvelope"), history.collisions("PBEnvelope")) == ((), ())
    assert history.commits == len(members)
    used = {int(member.split()[-1][:-1]) for there in members.values() for member in there}
    assert set(history.numbers("PBEnvelope")) == used
    for number, (usage,) in history.numbers("PBEnvelope").items():
        member = f"Message{number} member_{number} = {number};"
        assert usage.live_at == tuple(
            sorted(f"refs/heads/b{mark}" for mark, there in members.items() if member in there)
        )


def _give_away(random: Random, members: set[str]) -> None:
    """Numbers are given to whatever comes."""
    kept = {member.split()[-1]: member for member in sorted(members) if random.random() < 0.8}
    type, number = random.choice(["Imu", "Gps", "Ph", "LoadCell"]), random.randint(1, 3)
    kept[f"{number};"] = f"{type} {type.lower()} = {number};"
    members.clear()
    members.update(kept.values())


@pytest.mark.slow
@settings(_EXAMPLES, max_examples=20)
@given(st.randoms(use_true_random=False))
def test_every_use_is_found_where_it_came(random: Random) -> None:
    """In any graph of commits, a use comes where a commit has it and no parent had; numbers of two uses are found."""
    random = Random(random.getrandbits(64))  # noqa: S311  # one draw a history
    with tempfile.TemporaryDirectory() as folder:
        members = _random_history(random, Path(folder), _give_away)
        history = read_history(Path(folder))
        log = git(Path(folder), "log", "--all", "--format=%s %p").splitlines()
        marks = dict(line.split() for line in git(Path(folder), "log", "--all", "--format=%h %s").splitlines())
    parents = {int(words[0]): [int(marks[id]) for id in words[1:]] for words in map(str.split, log)}
    came: dict[str, set[str]] = {}
    for mark, there in members.items():
        for member in there - set().union(*(members[parent] for parent in parents[mark])):
            came.setdefault(member, set()).add(str(mark))
    usages = [usage for usages in history.numbers("PBEnvelope").values() for usage in usages]
    assert {
        f"{usage.type} {usage.name} = {usage.number};": {one.came.subject for one in usage.intervals}
        for usage in usages
    } == came
    uses: dict[int, set[str]] = {}
    for usage in usages:
        uses.setdefault(usage.number, set()).add(usage.type)
    assert {reuse.number for reuse in history.reuses("PBEnvelope")} == {
        n for n, types in uses.items() if len(types) > 1
    }


def test_a_tag_makes_the_reuse_of_a_branch_public(repository: RepositoryBuilder) -> None:
    """What only an unmerged branch has done may still be changed, unless it was released under a tag."""
    begin = _payloads(repository, IMU)
    repository.commit("Locate", {_FILE: envelope(IMU, GPS)}, branch="side", parents=[begin])
    repository.commit("Weigh", {_FILE: envelope(IMU, "LoadCell load_cell = 2;")}, branch="side")
    root = repository.write()
    assert [reuse.unmerged for reuse in read_history(root).reuses("PBEnvelope")] == [True]
    git(root, "tag", "v1", "side")
    assert [reuse.unmerged for reuse in read_history(root).reuses("PBEnvelope")] == [False]
